# SPDX-License-Identifier: GPL-3.0-or-later
"""What operations compute of constants, by the functions of functions.py: arrays (..., 3), a number being a grey colour."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .. import functions as f
from ..spectrum import blackbody, wavelength

Fold = Callable[..., Any]


def _numbers() -> dict[str, Fold]:
    return {name: f.MATH[operation] for operation, name in MATH.items()}


def _vectors() -> dict[str, Fold]:
    return {name: f.VECTOR_MATH[operation] for operation, name in VECTOR_MATH.items()}


def _mix(function: Fold) -> Fold:
    def mixed(t: Any, a: Any, b: Any, clampFactor: bool = True, clampResult: bool = False) -> Any:
        value = function(np.clip(t, 0.0, 1.0) if clampFactor else t, a, b)
        return np.clip(value, 0.0, 1.0) if clampResult else value

    return mixed


def _map_range(interpolation: str) -> Fold:
    return lambda *values, clamp=False: f.map_range(interpolation, clamp)(*values)


def _component(index: int) -> Fold:
    return lambda v: v[..., index]


def _table(x: Any, table: Any, start: float = 0.0, end: float = 1.0, extrapolate: bool = True) -> Any:
    """Linear between rows at equal steps."""
    table = np.asarray(table, float)
    last = len(table) - 1
    p = (x - start) / (end - start) * last
    i = np.clip(np.floor(p).astype(int), 0, last - 1)
    t = p - i if extrapolate else np.clip(p, 0, last) - i
    return table[i] + t * (table[i + 1] - table[i])


def _curve(t: Any, x: Any, table: Any, extrapolate: bool = True, **ends: float) -> Any:
    return x + t * (_table(x, table, ends.get("from", 0.0), ends.get("to", 1.0), extrapolate) - x)


def _curves(t: Any, x: Any, table: Any, extrapolate: bool = True, **ends: float) -> Any:
    columns = np.asarray(table, float).T
    return np.array([_curve(t[i], x[i], columns[i], extrapolate, **ends) for i in range(3)])


def _ramp(columns: slice) -> Fold:
    def ramp(t: Any, table: Any, interpolate: bool = True) -> Any:
        rows = np.asarray(table, float)[:, columns]
        p = float(np.clip(t[0], 0.0, 1.0)) * (len(rows) - 1)
        i = min(int(p), len(rows) - 1)
        return rows[i] + (p - i) * (rows[min(i + 1, len(rows) - 1)] - rows[i]) if interpolate else rows[i]

    return ramp


def _mapping(v: Any, matrix: Any) -> Any:
    m = np.asarray(matrix, float).reshape(3, 4)
    return m[:, :3] @ v + m[:, 3]


def _hue_saturation(hue: Any, saturation: Any, value: Any, share: Any, color: Any, version: int = 5) -> Any:
    return f.adjusted(hue, saturation, value, share, color)


# Blender's names of operations and blends -> ours
MATH = {
    **{name: name.lower().replace("_", "-") for name in f.MATH},
    "SMOOTH_MIN": "smooth-minimum",
    "SMOOTH_MAX": "smooth-maximum",
    "TRUNC": "truncate",
    "FRACT": "fraction",
    "PINGPONG": "ping-pong",
    "SINE": "sin",
    "COSINE": "cos",
    "TANGENT": "tan",
    "ARCSINE": "asin",
    "ARCCOSINE": "acos",
    "ARCTANGENT": "atan",
    "ARCTAN2": "atan2",
}
VECTOR_MATH = {
    **{name: f"vector-{name.lower().replace('_', '-')}" for name in f.VECTOR_MATH},
    "CROSS_PRODUCT": "vector-cross",
    "DOT_PRODUCT": "vector-dot",
    "SINE": "vector-sin",
    "COSINE": "vector-cos",
    "TANGENT": "vector-tan",
}
BLENDS = {name: f"mix-{name.lower().replace('_', '-')}" for name in f.BLENDS} | {"MIX": "mix"}
RANGES = {
    "LINEAR": "map-range",
    "STEPPED": "map-range-stepped",
    "SMOOTHSTEP": "map-range-smoothstep",
    "SMOOTHERSTEP": "map-range-smootherstep",
}

FOLDS: dict[str, Fold] = {
    **_numbers(),
    **_vectors(),
    **{BLENDS[blend]: _mix(function) for blend, function in f.BLENDS.items()},
    **{name: _map_range(interpolation) for interpolation, name in RANGES.items()},
    **{f"vector-{name}": _map_range(interpolation) for interpolation, name in RANGES.items()},
    "mix-number": _mix(lambda t, a, b: a * (1.0 - t) + b * t),
    "mix-vector": _mix(lambda t, a, b: a * (1.0 - t) + b * t),
    "mix-vector-each": _mix(lambda t, a, b: a * (1.0 - t) + b * t),
    "vector": lambda x: x,
    "combine": lambda x, y, z: np.array([x[0], y[0], z[0]]),
    "x": _component(0),
    "y": _component(1),
    "z": _component(2),
    "luminance": f.luminance,
    "mean": np.mean,
    "clamp": f.clamped,
    "clamp-range": f.clamped_to_range,
    "curve": _curve,
    "curves": _curves,
    "ramp": _ramp(slice(0, 3)),
    "ramp-alpha": _ramp(slice(3, 4)),
    "mapping": _mapping,
    "gamma": f.gamma,
    "bright-contrast": f.brightened,
    "invert": lambda t, c: c + t * (1.0 - 2.0 * c),
    "hue-saturation": _hue_saturation,
    "rgb-to-hsv": f.to_hsv,
    "hsv-to-rgb": f.from_hsv,
    "rgb-to-hsl": f.to_hsl,
    "hsl-to-rgb": f.from_hsl,
    "blackbody": lambda x, version=5: np.array(blackbody(float(x[0]), version)),
    "wavelength": lambda x, version=5: np.array(wavelength(float(x[0]), version)),
}
