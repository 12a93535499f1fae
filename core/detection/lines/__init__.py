# SPDX-License-Identifier: GPL-3.0-or-later
"""Feature lines on the surface: found, cleared, linked."""
