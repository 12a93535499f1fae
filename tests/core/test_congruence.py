# SPDX-License-Identifier: GPL-3.0-or-later
"""Groups of clean curves that motions take onto each other."""

from __future__ import annotations

import numpy as np
import pytest

from core.congruence import _grouped, congruent_parts, find_alike
from tests import naive
from tests.core import shapes
from tests.core.known_drafts import PARAMETERS, TURNED


def congruent(curves, owner):
    p = PARAMETERS
    alike = find_alike(curves, l0=p.l0, s=p.s, t=p.t, delta_l=p.delta_l, epsilon=p.epsilon)
    return congruent_parts(alike, owner, l0=p.l0)


def test_motions_lead_from_the_first_place_to_the_others(rng):
    thing = shapes.ornament(rng, 3, size=24)
    places = [np.eye(4), TURNED, naive.rigid(naive.turn([1, 0, 0], 2.0), [110, 0, 20])]
    curves = [naive.moved(m, c) + 0.1 * rng.normal(size=c.shape) for m in places for c in thing]
    curves += [c + [0, 0, 150] for c in shapes.ornament(rng, 2, size=24)]
    order = rng.permutation(len(curves))
    (one,) = congruent([curves[k] for k in order], [int(k) // 3 for k in order])
    assert np.allclose(one[0][0], np.eye(4)) and len(one) == 3
    sets = [sorted(int(order[k]) for k in members) for _, members in one]
    assert sorted(sets) == [[0, 1, 2], [3, 4, 5], [6, 7, 8]]
    start = places[sets[0][0] // 3]
    for (motion, _), members in zip(one, sets):
        truth = places[members[0] // 3] @ np.linalg.inv(start)
        at = np.concatenate([curves[k] for k in sets[0]])
        assert np.linalg.norm(naive.moved(motion, at) - naive.moved(truth, at), axis=1).mean() < 0.3


@pytest.mark.parametrize("count, owners, groups", [(3, 1, 1), (2, 1, 0), (2, 2, 1), (1, 2, 1)])
def test_how_many_curves_make_a_copy(rng, count, owners, groups):
    """Within one template three; between two they must be nearly all of both."""
    thing = shapes.ornament(rng, count, size=24)
    rest = [c + [0, 0, 60] for c in shapes.ornament(rng, 2, size=24)] if owners == 1 else []
    curves = thing + [naive.moved(TURNED, c) for c in thing] + rest
    owner = [0] * count + [owners - 1] * count + [0] * len(rest)
    assert len(congruent(curves, owner)) == groups


def test_templates_that_have_a_part_in_common_are_not_one(rng):
    thing, more, other = (shapes.ornament(rng, n, size=24) for n in (3, 2, 2))
    curves = thing + [c + [0, 0, 30] for c in more]
    curves += [naive.moved(TURNED, c) for c in [*thing, *(c + [0, 0, 30] for c in other)]]
    assert congruent(curves, [0] * 5 + [1] * 5) == []


def test_places_are_chained_by_the_motions_between_them(rng):
    """Five places of one thing and two of another, known by the motions between some pairs of them."""
    places = [shapes.random_motion(rng) for _ in range(5)]
    pairs = [(1, 3), (3, 4), (0, 1), (2, 4)]
    found = [(places[b] @ np.linalg.inv(places[a]), [a], [b]) for a, b in pairs]
    other = shapes.random_motion(rng)
    # what would join two places that are known already, or two groups, tells nothing new
    found += [(other, [7], [8]), (shapes.random_motion(rng), [0], [2]), (shapes.random_motion(rng), [7], [3])]
    one, two = _grouped(found)
    assert sorted(members[0] for _, members in one) == [0, 1, 2, 3, 4]
    start = places[one[0][1][0]]
    for motion, members in one:
        assert np.allclose(motion @ start, places[members[0]])
    assert [members for _, members in two] == [[7], [8]] and np.allclose(two[1][0], other)
    assert _grouped([]) == []


def test_curves_that_are_too_few_or_too_short(rng):
    assert congruent([shapes.wiggle(rng, 40)], [0]) == []
    short = shapes.wiggle(rng, 8, bend=0.4)
    assert congruent([short, naive.moved(TURNED, short)], [0, 1]) == []
