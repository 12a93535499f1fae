# SPDX-License-Identifier: GPL-3.0-or-later
"""From overlaid occurrences to clean curves (section 5.2)."""
