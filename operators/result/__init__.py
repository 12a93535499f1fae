# SPDX-License-Identifier: GPL-3.0-or-later
"""Work with a result as a whole and with its transformations."""
