# SPDX-License-Identifier: GPL-3.0-or-later
"""What the core raises: nothing else leaves it on bad input or on a stop."""


class InputError(ValueError):
    """Input that cannot be used; the message names the value and the remedy in one line."""


class Cancelled(Exception):
    """Raised by a progress callback to stop the analysis; nothing is returned."""


class NoCurves(InputError):
    """An input that can be read and has no curve in it; among others it is passed over."""
