# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenBLAS is held to one thread within, and given back as it was."""

from __future__ import annotations

import numpy as np
import pytest

from core.threads import _libraries, single_threaded


def test_one_thread_within_and_as_before_after():
    before = [get() for _, get in _libraries()]
    if not before:
        pytest.skip("this numpy brings no OpenBLAS of its own")
    with single_threaded():
        assert [get() for _, get in _libraries()] == [1] * len(before)
        assert np.allclose(np.eye(300) @ np.full((300, 300), 2.0), 2.0)
    assert [get() for _, get in _libraries()] == before
    with pytest.raises(KeyError), single_threaded():
        raise KeyError
    assert [get() for _, get in _libraries()] == before
