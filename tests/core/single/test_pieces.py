# SPDX-License-Identifier: GPL-3.0-or-later
"""What is left of curves that are explained in part."""

import numpy as np

from core.network.building import build_network
from core.single.pieces import pieces_of, runs
from core.values import Curves
from tests.core import shapes


def network(*curves, closed=None):
    return build_network(Curves.from_list(list(curves), closed), edge_length=1.0, smoothing=0)


def free(net, taken):
    """Samples but those that `taken` (curve, first, stop) names."""
    flags = np.ones(len(net.points), bool)
    for i, first, stop in taken:
        flags[net.offsets[i] + first : net.offsets[i] + stop] = False
    return flags


def test_runs_of_a_ring_go_round():
    flags = np.array([1, 1, 0, 0, 1], bool)
    assert [r.tolist() for r in runs(flags, True)] == [[4, 0, 1], [2, 3]]
    assert [r.tolist() for r in runs(flags, False)] == [[0, 1], [2, 3], [4]]


def test_whole_curves_are_pieces_or_known():
    ring = shapes.circle(8, (0, 40, 0))
    net = network(shapes.line(30), shapes.line(20, [0, 9, 0]), ring, closed=[False, False, True])
    left, known = pieces_of(net, free(net, []))
    assert sorted(p.curve for p in left) == [0, 1, 2] and not known
    assert sum(p.closed for p in left) == 1
    left, known = pieces_of(net, np.zeros(len(net.points), bool))
    assert not left and len(known) == 3


def test_rests_take_part_from_eight_edges_on():
    net = network(shapes.line(61))
    for rest, many in ((9, 1), (8, 0)):
        left, known = pieces_of(net, free(net, [(0, rest, rest + 10)]))
        assert [len(p.points) for p in left] == [rest] * many + [61 - rest - 10]
        assert [len(p.points) for p in known] == [10]


def test_a_curve_that_is_mostly_explained_leaves_no_rest():
    net = network(shapes.line(61))
    assert not pieces_of(net, free(net, [(0, 0, 31)]))[0]
    assert len(pieces_of(net, free(net, [(0, 0, 30)]))[0]) == 1
