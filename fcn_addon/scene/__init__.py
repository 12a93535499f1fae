# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's data as arrays, and arrays as Blender's data."""
