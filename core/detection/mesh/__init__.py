# SPDX-License-Identifier: GPL-3.0-or-later
"""A triangle mesh and its arrays."""
