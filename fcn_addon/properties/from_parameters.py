# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender properties made from the fields of a dataclass of parameters, and back."""

from __future__ import annotations

from dataclasses import fields
from math import degrees, inf, radians

from bpy.props import FloatProperty, IntProperty

from ...core.detection.parameters import DEGREES
from ...core.parameters import COUNT


def properties_of(of, words, update=None) -> dict:
    """A property for each field, with its default, bounds and words.

    words : field name -> its name in the interface and what it does, where these are not those of the field
    update : what Blender calls when one changes, or field name -> that, with the one for all others under None
    """
    calls = update if isinstance(update, dict) else {None: update}
    return {f.name: _property(f, words, calls.get(f.name, calls[None])) for f in fields(of)}


def with_unit(of, unit) -> set[str]:
    """Names of the fields that have a unit."""
    return {field.name for field in fields(of) if field.metadata["unit"] == unit}


def _property(field, words, update):
    low, high = field.metadata["low"], field.metadata["high"]
    name, text = words.get(field.name, (field.name.replace("_", " ").title(), field.metadata["help"]))
    common = {"name": name, "description": text[:1].upper() + text[1:], "update": update}
    if field.metadata["unit"] == COUNT:
        high = {} if high == inf else {"max": int(high)}
        return IntProperty(default=int(field.default), min=int(low), **high, **common)
    if field.metadata["unit"] == DEGREES:
        low, high, default = radians(low), radians(high), radians(field.default)
        return FloatProperty(default=default, min=low, max=high, subtype="ANGLE", precision=2, step=10, **common)
    high = {} if high == inf else {"max": high}
    return FloatProperty(default=field.default, min=low, **high, precision=2, step=10, **common)


def read(group, of):
    """The validated parameters from their properties.

    Properties hold float32; six digits take 1.5 degrees back to 1.5.
    """
    values = {}
    for field in fields(of):
        value = getattr(group, field.name)
        if field.metadata["unit"] == DEGREES:
            value = degrees(value)
        values[field.name] = int(value) if field.metadata["unit"] == COUNT else float(f"{value:.6g}")
    return of(**values).validate()


def write(group, values):
    """Write parameters to their properties."""
    for field in fields(values):
        value = getattr(values, field.name)
        setattr(group, field.name, radians(value) if field.metadata["unit"] == DEGREES else value)
