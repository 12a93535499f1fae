# SPDX-License-Identifier: GPL-3.0-or-later
"""Curve and mesh files, without Blender. `reading.read_curves` and `reading.read_surface` are the way in."""
