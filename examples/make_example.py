# SPDX-License-Identifier: GPL-3.0-or-later
"""Make `facade.obj`, the example of the README: `python -m examples.make_example` in the folder above.

A wall with pointed windows in two rows and a rosette above them, as curve detection on a scan would show it: broken,
jagged, with holes and with curves that are nothing. It stands upright (z is up), one unit is a metre.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.scenes import EDGE_LENGTH, Scene, obj_text
from benchmarks.scenes.damage import LEVELS, damaged
from benchmarks.scenes.layouts import cells
from benchmarks.scenes.network import Network, shifts, turns
from benchmarks.scenes.ornaments import gothic_window, petal
from benchmarks.scenes.shapes import circle, line, resample

OUT = Path(__file__).with_name("facade.obj")
SEED = 2018
PETALS = 8
UPRIGHT = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])


def example_network() -> Network:
    """The wall as it was built: eight windows, a rosette of eight petals in its ring, and two mouldings."""
    rng = np.random.default_rng(SEED)
    network = Network()
    network.repeat(gothic_window(rng, 0.75), shifts(cells(4, 2, (1.4, 0), (0, 1.9))))
    centre = np.array([2.1, 5.5, 0.0])
    around = [(turn, centre) for turn, _ in turns(np.arange(PETALS) * 360 / PETALS)]
    network.repeat([0.76 * c for c in petal(rng, 360 / PETALS)], around)
    network.keep(circle(centre, 1.62, z=0.08))
    network.keep(line((-0.8, -0.4, 0.1), (4.9, -0.4, 0.1)), line((-0.8, 3.65, 0.1), (5.0, 3.65, 0.1)))
    return network


def example_scene() -> Scene:
    """The damaged network and its truth; the same at every call."""
    network = example_network()
    truth = [resample(c, EDGE_LENGTH) @ UPRIGHT.T for c in network.curves]
    rng = np.random.default_rng(SEED)
    curves, labels = damaged(truth, network.labels, LEVELS["medium"], step=EDGE_LENGTH, rng=rng)
    return Scene(curves, np.array(labels, np.int64), truth, np.array(network.labels, np.int64))


if __name__ == "__main__":
    OUT.write_text(obj_text(example_scene().curves), encoding="ascii", newline="\n")
    print(f"{OUT}: {OUT.stat().st_size} bytes")
