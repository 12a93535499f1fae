# SPDX-License-Identifier: GPL-3.0-or-later
"""Transformations that generate many poses (section 4.1.2, after Pauly et al. 2008)."""
