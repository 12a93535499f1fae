# SPDX-License-Identifier: GPL-3.0-or-later
"""A result in four pictures, as the paper shows its own: input, completed network, components, templates."""

from __future__ import annotations

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ..core.files.writers.plan import main_plane
from ..fcn_addon import colours

INPUT = (0.15, 0.15, 0.15)
PANELS = ("input", "completed network", "components", "templates")


def draw(report, curves, path):
    """Draw a report to an image file.

    Parameters
    ----------
    report : dict, `fcn-report/1`
    curves : Curves, the input that it is about
    path : where to; the ending chooses the format
    """
    axes = main_plane(curves.points)
    centre = curves.points.mean(axis=0)
    pieces = [_flat(curves.curve(i), curves.closed[i], centre, axes) for i in range(len(curves))]
    classes = [report["inputs"][i] for i in curves.source]
    made = report["curves"]
    clean = [_flat(np.array(c["points"]), c["closed"], centre, axes) for c in made]
    by_component = [_distinct(c["component"]) for c in classes]
    grey = (*colours.NOISE, 0.5)
    contents = (
        (pieces, [INPUT] * len(pieces)),
        (clean, [colours.TEMPLATE if c["kind"] == "template" else colours.STRONG for c in made]),
        (pieces, [colour or grey for colour in by_component]),
        (clean, [_distinct(c["template"]) or colours.STRONG for c in made]),
    )
    span = np.ptp(np.concatenate([*pieces, *clean]), axis=0)
    # Each panel is as high as the scene asks for, within what a page can hold.
    width = 6.0
    height = width * float(np.clip(span[1] / max(span[0], 1e-12), 0.3, 1.6))
    figure = Figure(figsize=(2 * width, 2 * height + 0.8), facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(2, 2, sharex=True, sharey=True).ravel()
    for panel, title, (lines, colour) in zip(panels, PANELS, contents):
        panel.add_collection(LineCollection(lines, colors=colour, linewidths=0.6))
        panel.set_aspect("equal")
        panel.autoscale_view()
        panel.set_axis_off()
        panel.set_title(title, fontsize=10)
    figure.savefig(path, dpi=160)


def draw_detected(found, path):
    """Draw detected curves to an image file: ridges red, valleys blue, sharp edges black, boundaries green.

    Parameters
    ----------
    found : list of FeatureCurves, drawn into one picture
    """
    points = np.concatenate([f.curves.points for f in found])
    axes, centre = main_plane(points), points.mean(axis=0)
    lines = [_flat(f.curves.curve(i), f.curves.closed[i], centre, axes) for f in found for i in range(len(f))]
    colour = [colours.KINDS[kind] for f in found for kind in f.kind]
    span = np.ptp(np.concatenate(lines), axis=0)
    width = 12.0
    figure = Figure((width, width * float(np.clip(span[1] / max(span[0], 1e-12), 0.3, 1.6))), layout="constrained")
    FigureCanvasAgg(figure)
    panel = figure.subplots()
    panel.add_collection(LineCollection(lines, colors=colour, linewidths=0.8))
    panel.set_aspect("equal")
    panel.autoscale_view()
    panel.set_axis_off()
    figure.savefig(path, dpi=120)


def _distinct(label):
    return None if label is None or label < 0 else colours.distinct(label)


def _flat(points, closed, centre, axes) -> np.ndarray:
    """(k, 2) float64, a polyline in the picture, closed by its first point."""
    points = (points - centre) @ axes.T
    return np.concatenate([points, points[:1]]) if closed else points
