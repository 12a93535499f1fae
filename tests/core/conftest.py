# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the core share."""

from __future__ import annotations

import numpy as np
import pytest


@pytest.fixture
def rng():
    return np.random.default_rng(0)
