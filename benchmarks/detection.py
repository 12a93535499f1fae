# SPDX-License-Identifier: GPL-3.0-or-later
"""Quality and cost of detection: `python -m benchmarks.detection [surfaces] [noise] [scan] [cost] [scans]`.

`scans` compares with CGAL's crest lines of the same meshes (`NAME.ply` beside `NAME.cgal_ridges.txt` in a folder
`shared/data` beside the checkout) and is left out where there are none. Lengths are in edge lengths.
"""

from __future__ import annotations

import sys
import time
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from benchmarks.bending import Bending
from core.detection import DetectionParameters, FeatureCurves, TriangleMesh, detect, measure
from core.detection.curvature.tensor import curvature
from core.files.formats import read_surface
from examples.make_scan import scan
from tests.core.detection import surfaces

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
CGAL_SECONDS_PER_FACE = 72e-6
CONVEX, CONCAVE = 6, 3


def polylines(found: FeatureCurves, kind=None) -> list:
    """The curves as (k, 3) arrays, closed ones with their first point again at the end."""
    chosen = range(len(found)) if kind is None else np.flatnonzero(found.kind == kind)
    curves = [(found.curves.curve(i), found.curves.closed[i]) for i in chosen]
    return [np.concatenate([p, p[:1]]) if closed else p for p, closed in curves]


def sampled(lines, step) -> np.ndarray:
    """(k, 3) points along polylines about `step` apart."""
    out = [np.zeros((0, 3))]
    for p in lines:
        at = np.r_[0, np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))]
        t = np.linspace(0, at[-1], int(at[-1] / step) + 2)
        out.append(np.stack([np.interp(t, at, p[:, k]) for k in range(3)], axis=1))
    return np.concatenate(out)


def distances(of, to) -> np.ndarray:
    """From each point of one set to the nearest of the other."""
    return cKDTree(to).query(of)[0] if len(to) else np.full(len(of), np.inf)


def length(p) -> float:
    return float(np.linalg.norm(np.diff(p, axis=0), axis=1).sum())


def on_surfaces():
    """Curvature errors at rising resolution, and the distance of crest lines from the exact ones."""
    print("principal curvatures, root mean square error over the largest curvature, in percent")
    rows = [
        ("torus", surfaces.torus, (48, 96, 192), {}, None),
        ("saddle", surfaces.saddle, (31, 61, 121), {"jitter": 0.0}, 0.6),
        ("monkey saddle", surfaces.monkey_saddle, (31, 61, 121), {"jitter": 0.0}, 0.6),
        ("saddle, uneven", surfaces.saddle, (31, 61, 121), {}, 0.6),
        ("monkey saddle, uneven", surfaces.monkey_saddle, (31, 61, 121), {}, 0.6),
    ]
    for scale, power in ((0.0, 0), (0.7, 0), (0.7, 0.5), (1.5, 0.5)):
        for name, make, sizes, options, within in rows:
            details = [scale * (n / sizes[0]) ** power for n in sizes]
            errors = [100 * _error(*make(n, **options), d, within) for n, d in zip(sizes, details)]
            told = " ".join(f"{d:.1f}" for d in details)
            print(f"  detail {told}  {name:22s}" + "".join(f"{e:8.3f}" for e in errors))
    gentle = DetectionParameters(detail=1.0, strong_fold=2.0, weak_fold=0.5)
    for level in (4, 5, 6):
        mesh = TriangleMesh.of(*surfaces.ellipsoid(level))
        found = detect(mesh, parameters=gentle)
        angle = np.linspace(0, 2 * np.pi, 2000)
        rim = np.column_stack([3 * np.cos(angle), 2 * np.sin(angle), 0 * angle])
        _crest("ellipsoid", mesh, found, rim, None)
    for n in (24, 36, 48):
        mesh = TriangleMesh.of(*surfaces.rounded_box(n))
        inner = np.array([1.0, 0.8, 0.6]) - 0.2 - mesh.edge_length
        _crest("rounded box", mesh, detect(mesh), surfaces.box_crests(), inner)
    for name, made in (("sphere", surfaces.sphere(5)), ("plane", surfaces.graph(100, lambda x, y: 0 * x))):
        print(f"  {name}: {len(detect(TriangleMesh.of(*made), parameters=gentle))} curves")


def _error(v, f, k, scale, within):
    mesh = TriangleMesh.of(v, f)
    field = curvature(mesh, scale * mesh.edge_length)
    inner = np.ones(len(mesh.vertices), bool) if within is None else np.abs(mesh.vertices[:, :2]).max(axis=1) < within
    exact = k[mesh.vertex_source][inner]
    off = np.stack([field.high, field.low], axis=1)[inner] - exact
    return np.sqrt(np.mean(off**2)) / np.abs(exact).max()


def _crest(name, mesh, found, exact, inner):
    h = mesh.edge_length
    p = sampled(polylines(found), h / 20)
    kept = p if inner is None else p[(np.abs(p) < inner).any(axis=1)]
    missed, off = distances(exact, p).max() / h, distances(kept, exact).max() / h
    print(f"  {name}, {len(mesh.faces)} faces: {len(found)} curves; exact to found {missed:.3f}, back {off:.3f} edges")


def under_noise():
    """Pieces and length per true curve of a corrugated sheet and a rounded box."""
    print("noise in percent of the bounding box diagonal: pieces per true curve, share of the true length")
    v, f, at = surfaces.folded_sheet(110, 7, 50.0)
    for share in (0.0, 0.0005, 0.001, 0.002):
        for detail in (0, 0.7):
            mesh = TriangleMesh.of(surfaces.noisy(v, share), f)
            found = detect(mesh, detail=detail)
            y = np.linspace(-0.97, 0.97, 400)
            rise = np.tan(np.radians(25)) * (at[1] - at[0])
            pieces, seen = [], []
            for i, x in enumerate(at):
                truth = np.column_stack([np.full(400, x), y, np.full(400, rise if i % 2 == 0 else 0)])
                seen.append(distances(truth, sampled(polylines(found, i % 2), mesh.edge_length / 4)) < mesh.edge_length)
                pieces.append(sum(abs(np.median(p[:, 0]) - x) < 2 * mesh.edge_length for p in polylines(found, i % 2)))
            extra = len(found) - sum(pieces)
            relative = share * np.linalg.norm(np.ptp(v, axis=0)) / mesh.edge_length
            print(
                f"  sheet {100 * share:5.2f}% ({relative:4.2f} edges) detail {found.detail:.2f}: "
                f"{np.mean(pieces):5.2f} pieces, {np.mean(seen):.3f} of the length, {extra} curves that are none"
            )

    # noise on the box as it is made would tear its seams
    clean = TriangleMesh.of(*surfaces.rounded_box(48))
    edges = surfaces.box_crests().reshape(12, -1, 3)
    for share in (0.0, 0.0005, 0.001, 0.002):
        mesh = TriangleMesh.of(surfaces.noisy(clean.vertices, share), clean.faces)
        h = mesh.edge_length
        curves = [sampled([p], h / 4) for p in polylines(detect(mesh), 0)]
        seen = distances(edges.reshape(-1, 3), np.concatenate(curves)) < h
        # a curve is a piece of an edge if it follows it over two edge lengths
        pieces = [sum((distances(c, e) < h).sum() * h / 4 > 2 * h for c in curves) for e in edges]
        relative = share * np.linalg.norm(np.ptp(clean.vertices, axis=0)) / h
        told = f"{np.mean(pieces):5.2f} pieces, {np.mean(seen):.3f} of the length, {len(curves)} curves"
        print(f"  box   {100 * share:5.2f}% ({relative:4.2f} edges) {told}")


def on_the_example():
    """The example scan against the creases that it was built from."""
    made = scan()
    mesh = TriangleMesh.of(made.vertices, made.faces)
    h = mesh.edge_length
    found = detect(mesh)
    print(f"example scan: {len(mesh.faces)} faces, {len(found)} curves for {len(made.curves)} creases")
    for kind, name in enumerate(("ridge", "valley")):
        lines = [
            np.concatenate([c, c[:1]]) if z else c for c, z, k in zip(made.curves, made.closed, made.kinds) if k == name
        ]
        truth, ours = sampled(lines, h / 4), sampled(polylines(found, kind), h / 4)
        told = [_within(distances(a, b) / h) for a, b in ((truth, ours), (ours, truth))]
        print(f"  {name:6s} within 1 (2) edges: of the creases {told[0]} are found, of the curves {told[1]} are true")


def _within(off) -> str:
    return f"{(off <= 1).mean():.3f} ({(off <= 2).mean():.3f})"


def cost():
    """Seconds and bytes per face at rising size."""
    print(f"cost (CGAL's Ridges_3 took {1e6 * CGAL_SECONDS_PER_FACE:.0f} us a face on a castle of 175,000 faces)")
    for n in (100, 200, 400, 800):
        v, f, _ = surfaces.folded_sheet(n, 7, 50.0)
        v = surfaces.noisy(v, 0.05 / n)
        start = time.process_time()
        mesh = TriangleMesh.of(v, f)
        detect(mesh)
        seconds = time.process_time() - start
        tracemalloc.start()
        detect(TriangleMesh.of(v, f))
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        m = len(f)
        ratio = CGAL_SECONDS_PER_FACE * m / seconds
        pace = f"{1e6 * seconds / m:5.1f} us a face ({ratio:.1f} times CGAL's pace)"
        print(f"  {m:8d} faces: {pace}, {peak / m:5.0f} bytes a face")


def on_scans():
    """Real scans, against CGAL's crest lines of the same mesh."""
    for path in sorted(DATA.glob("*.cgal_ridges.txt")):
        _against(path.name.split(".")[0], path)


def _against(name, path):
    points, faces = read_surface(DATA / f"{name}.ply")
    start = time.process_time()
    mesh = TriangleMesh.of(points, faces)
    found = detect(mesh)
    seconds = time.process_time() - start
    h = mesh.edge_length
    rows = [np.array(line.split(), float) for line in path.read_text().splitlines()]
    rows = [r for r in rows if len(r) >= 9]
    theirs = [(int(r[0]), r[1], r[3:].reshape(-1, 3)) for r in rows]
    lengths = np.array([length(p) for _, _, p in theirs]) / h
    integral = np.array([s for _, s, _ in theirs])
    mean = integral / np.maximum(lengths * h, 1e-300)
    equal, fold = _of_total(mesh, lengths.sum())
    own = equal.length / h
    kept = _longest_prefix(lengths, np.argsort(-mean), own.sum())
    ratio = own[own > 20].sum() / max(lengths[kept][lengths[kept] > 20].sum(), 1e-9)
    half = _longest_prefix(lengths, np.argsort(-integral), 0.5 * lengths.sum())
    strong = np.flatnonzero(mean > np.average(mean, weights=lengths))
    print(f"{name}: {len(mesh.faces)} faces, {1e6 * seconds / len(faces):.1f} us a face")
    print(f"  CGAL    {len(theirs):5d} {_totals(lengths)}")
    print(
        f"  equal   {len(own):5d} {_totals(own)} "
        f"(strong_fold {fold:.1f}); {ratio:.2f} times CGAL's strongest of that total"
    )
    print(
        f"          of CGAL's length within 1 (2) edges of ours: {_covered(theirs, half, equal, h)} of the half "
        f"with the largest strength, {_covered(theirs, strong, equal, h)} of what bends more than the mean"
    )
    _judged(mesh, theirs, half, found)
    own = found.length / h
    print(f"  default {len(own):5d} {_totals(own)}, "
          f"{(own > 25).sum()} curves over 25 edges (CGAL {(lengths > 25).sum()})")  # fmt: skip


def _totals(lengths) -> str:
    return f"curves, total {lengths.sum():6.0f}, in curves over 20 edges {lengths[lengths > 20].sum():6.0f}"


def _of_total(mesh, total):
    """Curves with thresholds such that their length is that total (edge lengths), as far as there is so much."""
    parameters = DetectionParameters()
    field = measure(mesh)
    low, high, best = 0.2, 60.0, None
    for _ in range(9):
        fold = np.sqrt(low * high)
        weak = min(parameters.weak_fold, 0.4 * fold)
        tried = replace(parameters, strong_fold=fold, weak_fold=weak, strong_length=1, noise=0)
        found = detect(mesh, field=field, parameters=tried)
        if found.length.sum() > total * mesh.edge_length:
            low = fold
        else:
            high, best = fold, found
    return best if best is not None else found, high


def _judged(mesh, theirs, half, found):
    """CGAL's strongest half against the defaults, where the mesh itself bears it out, and who is right elsewhere."""
    h, bending = mesh.edge_length, Bending(mesh)
    off, sound, gain = [], [], []
    for kind, (code, sign) in enumerate(((CONVEX, 1), (CONCAVE, -1))):
        lines = sampled([theirs[i][2] for i in half if theirs[i][0] == code], h / 2)
        ours = sampled(polylines(found, kind), h / 8)
        distance, nearest = cKDTree(ours).query(lines)
        off.append(distance / h)
        sound.append(bending.borne_out(lines, sign))
        gain.append(sign * (bending(ours[nearest]) - bending(lines)))
    off, sound, gain = (np.concatenate(x) for x in (off, sound, gain))
    beside = (off > 1) & (off <= 2.5)
    print(
        f"  judged  {sound.mean():.2f} of that half is borne out by the mesh; of this {_within(off[sound])} lies "
        f"within 1 (2) edges of the default's lines, of the whole half {_within(off)}; where ours run 1 to 2.5 edges "
        f"beside ({beside.mean():.2f}) the mesh bends more at ours on {(gain[beside] > 0).mean():.2f}"
    )


def _longest_prefix(lengths, order, total):
    return order[np.cumsum(lengths[order]) <= total]


def _covered(theirs, chosen, found, h) -> str:
    off = []
    for kind, code in enumerate((CONVEX, CONCAVE)):
        lines = [theirs[i][2] for i in chosen if theirs[i][0] == code]
        off.append(distances(sampled(lines, h / 4), sampled(polylines(found, kind), h / 8)) / h)
    return _within(np.concatenate(off))


PARTS = {"surfaces": on_surfaces, "noise": under_noise, "scan": on_the_example, "cost": cost, "scans": on_scans}

if __name__ == "__main__":
    for part in sys.argv[1:] or PARTS:
        PARTS[part]()
