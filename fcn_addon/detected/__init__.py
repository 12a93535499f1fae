# SPDX-License-Identifier: GPL-3.0-or-later
"""What a detection leaves in the file."""
