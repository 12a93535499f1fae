# SPDX-License-Identifier: GPL-3.0-or-later
"""A module for each format that is written."""
