# SPDX-License-Identifier: GPL-3.0-or-later
"""Partial matches of curves and their votes (section 4.1.1)."""
