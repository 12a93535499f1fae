# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings, which are saved in the .blend."""
