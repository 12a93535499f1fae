# SPDX-License-Identifier: GPL-3.0-or-later
"""Work with single occurrences of a template."""
