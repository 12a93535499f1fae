# SPDX-License-Identifier: GPL-3.0-or-later
"""The feature curve network (section 4): curves as even samples in a frame of their own."""
