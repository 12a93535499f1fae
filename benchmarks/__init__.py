# SPDX-License-Identifier: GPL-3.0-or-later
"""What the claims of quality and speed come from; not part of the extension."""
