# SPDX-License-Identifier: GPL-3.0-or-later
"""Results on random scenes as lines and tables."""

from __future__ import annotations

import numpy as np

from .designs import LAYOUTS


def line_of(r) -> str:
    """One line for the eye: what was asked, what came out."""
    head = f"{r['name']:28s} {'pass' if r['passed'] else 'FAIL'} {r['rule']:5s} "
    tail = f" {r['seconds']:6.1f} s {r['peak'] / 2**20:5.0f} MB"
    if not r["measured"]:
        return head + ("not in time" if not r["in_time"] else f"no result: {r['said'].splitlines()[-1:]}") + tail
    able = r.get("completable", 1.0)
    reached = r["reached"] if r["rule"] == "goals" else dict.fromkeys(("F", "completed", "instances"), True)
    star = {name: " " if good else "*" for name, good in reached.items()}
    return (
        head
        + f"F {r['in_F']:.3f}>{r['out_F']:.3f}{star['F']}"
        + f" completed {r['completed']:.2f}{star['completed']}of {able:.2f}"
        + f" instances {r['instances_90']}/{r['instances']}{star['instances']}"
        + f" poses {r['pose_recall']:.2f} {r['pose_precision']:.2f}"
        + f" templates {r['templates']} x {r['occurrences']}"
        + f" stray {r['stray'] / max(r['drawn'], 1e-9):.1%}"
        + tail
    )


def share(values) -> str:
    """The mean of yes and no, with how many there were."""
    values = list(values)
    return f"{np.mean(values):.2f} ({sum(values)}/{len(values)})" if values else "-"


def mean(values, form="{:.3f}") -> str:
    """The mean, a dash of nothing."""
    values = list(values)
    return form.format(np.mean(values)) if values else "-"


def row_of(name, results) -> list[str]:
    """One row of the table."""
    judged = [r for r in results if r["rule"] == "goals"]
    F = [r["out_F"] if r["measured"] else 0.0 for r in judged]
    quantiles = " ".join(f"{q:.2f}" for q in np.quantile(F, [0.05, 0.25, 0.5])) if F else "-"
    goals = [mean(r["measured"] and r["reached"][g] for r in judged) for g in ("F", "completed", "instances")]
    poses = mean((r["pose_recall"] for r in judged if r["measured"]), "{:.2f}")
    seconds = f"{np.median([r['seconds'] for r in results]):.0f} {max(r['seconds'] for r in results):.0f}"
    return [name, str(len(results)), share(r["passed"] for r in results), *goals, quantiles, poses, seconds]


def table(results) -> str:
    """Shares that pass by layout, and what is asked of the whole."""
    rows = [["layout", "n", "pass", "F", "completed", "instances", "F 5 25 50%", "poses", "s 50% max"]]
    for layout in LAYOUTS:
        own = [r for r in results if r["layout"] == layout]
        rows += [row_of(layout, own)] if own else []
    recurring = [r for r in results if r["rule"] != "none"]
    rows += [row_of("all that recur", recurring)] if recurring else []
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in rows]
    twice, none = ([r for r in results if r["rule"] == rule] for rule in ("twice", "none"))
    measured = [r for r in results if r["measured"]]
    drawn = sum(r["drawn"] for r in measured)
    bare = [r for r in none if r["measured"]]
    lines += [
        "",
        f"seen twice and found: {share(r['passed'] for r in twice)}",
        f"nothing recurs, something found: {share(not r['passed'] for r in none)}",
        f"nothing recurs, F out minus in: {mean((r['out_F'] - r['in_F'] for r in bare), '{:+.3f}')}",
        f"drawn over 2 edges from every true curve: {sum(r['stray'] for r in measured) / max(drawn, 1e-9):.2%}",
        f"without a result: {sum(not r['measured'] for r in results)} of {len(results)}",
    ]
    return "\n".join(lines)
