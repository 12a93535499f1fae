# SPDX-License-Identifier: GPL-3.0-or-later
"""What the surface does at each vertex, and the noise in it."""
