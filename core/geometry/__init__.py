# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain functions on arrays: motions, polylines, chains, rows."""
