# SPDX-License-Identifier: GPL-3.0-or-later
"""The bridge between Blender and arrays. Nothing is imported here, so that the command line works without Blender."""
