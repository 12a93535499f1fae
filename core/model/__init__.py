# SPDX-License-Identifier: GPL-3.0-or-later
"""The one decision: which hypotheses the curves need (section 4.2)."""
