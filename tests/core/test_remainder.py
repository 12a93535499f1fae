# SPDX-License-Identifier: GPL-3.0-or-later
"""What a model leaves: the curves and votes that are left, and a small ring found beside a large row."""

from __future__ import annotations

import numpy as np
import pytest

from core.matching.blast import feature_blast
from core.matching.strong import strong_curves
from core.matching.voting import vote
from core.parameters import Parameters
from core.remainder import EXPLAINED, further_orbits, remainder
from core.selection import select_model
from core.support import Screen
from tests import naive
from tests.core import shapes

P = Parameters()
STEP, CELLS = naive.rigid(shift=[110, 0, 0]), 6
ORDER, HUB = 8, np.array([275.0, 0.0, 140.0])


def things(*, ring=True, seed=4):
    """A row of large things, above it a ring of small ones and clutter; and which curves are of the ring."""
    rng = np.random.default_rng(seed)
    large, small = shapes.ornament(rng, 5, size=40, count=100), shapes.ornament(rng, 1, size=28, count=70)
    curves = [naive.moved(np.linalg.matrix_power(STEP, k), c) for k in range(CELLS) for c in large]
    first = len(curves)
    turns = [naive.about([0, 1, 0], 2 * np.pi * k / ORDER, HUB) for k in range(ORDER)] if ring else []
    curves += [naive.moved(turn, c + HUB + [0, 0, 40]) for turn in turns for c in small]
    last = len(curves)
    curves += [shapes.wiggle(rng, 40) + rng.uniform(0, 350, size=3) * [1.7, 0.1, 0.5] for _ in range(25)]
    noisy = [c + 0.1 * rng.normal(size=c.shape) for c in curves]
    return noisy, np.arange(first, last)


def begun(curves):
    """The network, the votes, the screen and the model of the row alone."""
    net = shapes.network(curves)
    strong = strong_curves(net, l0=P.l0, strong_curvature=P.strong_curvature)
    matches = feature_blast(net, strong, l0=P.l0, s=P.s, t=P.t, delta_l=P.delta_l, threads=1)
    votes = vote(net, matches, bin_translation=P.bin_translation, bin_rotation=P.bin_rotation)
    screen = Screen(net, radius=P.epsilon, threads=1)
    row = shapes.orbit(net, "translation", [STEP], [CELLS - 1])
    model = select_model(net, [row], screen, l0=P.l0, t=P.t, bayes_ratio=P.bayes_ratio)
    assert len(model.orbits) == 1
    return net, votes, screen, model


@pytest.fixture(scope="module")
def with_ring():
    curves, ring = things()
    return (*begun(curves), ring)


def test_what_remains_is_what_the_row_does_not_map(with_ring):
    net, votes, _, model, ring = with_ring
    rest, left = remainder(net, model, votes)
    assert set(ring) <= set(rest.source) and len(rest) < len(net)
    hits = model.hits[0] > 0
    length = [net.weights[net.curve_of == i].sum() for i in range(len(net))]
    free = {i for i in range(len(net)) if net.weights[(net.curve_of == i) & hits].sum() < EXPLAINED * length[i]}
    pairs = [(a, b) for a, b in votes.pair if a in free and b in free]
    names = {int(net.source[i]): i for i in range(len(net))}
    kept = [names[int(s)] for s in rest.source]
    assert sorted(kept) == sorted({i for pair in pairs for i in pair})
    assert [(kept[a], kept[b]) for a, b in left.pair] == pairs
    for k, i in enumerate(kept):
        assert (rest.curve(k) == net.curve(i)).all() and rest.lengths[k] == pytest.approx(net.lengths[i])
        assert rest.closed[k] == net.closed[i] and (rest.curve_of == k).sum() == len(net.curve(i))
    assert (rest.to_world(rest.points[:1]) == net.to_world(net.curve(kept[0])[:1])).all()


def test_a_small_ring_beside_a_row_is_found(with_ring):
    net, votes, screen, model, ring = with_ring
    (found,) = further_orbits(net, model, votes, screen, P)
    assert found.kind == "rotation" and found.closed and found.count.tolist() == [ORDER - 1]
    turned = naive.moved(found.generators[0], net.points)
    turns = [shapes.in_frame(net, naive.about([0, 1, 0], s * 2 * np.pi / ORDER, HUB)) for s in (1, -1)]
    on_ring = np.isin(net.source[net.curve_of], ring)
    assert min(np.linalg.norm(naive.moved(t, net.points) - turned, axis=1)[on_ring].max() for t in turns) < 1
    both = select_model(net, [*model.orbits, found], screen, l0=P.l0, t=P.t, bayes_ratio=P.bayes_ratio)
    assert len(both.orbits) == 2


def test_clutter_has_nothing_more_in_it():
    curves, _ = things(ring=False)
    net, votes, screen, model = begun(curves)
    assert further_orbits(net, model, votes, screen, P) == []


def test_where_all_is_explained_nothing_remains():
    rng = np.random.default_rng(1)
    thing = shapes.ornament(rng, 4, size=40)
    curves = [naive.moved(np.linalg.matrix_power(STEP, k), c) for c in thing for k in range(CELLS)]
    net, votes, screen, model = begun(curves)
    rest, left = remainder(net, model, votes)
    assert len(rest) == len(left) == 0 and further_orbits(net, model, votes, screen, P) == []
