#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes operations.json: what operations of programs compute, in double precision by numpy, for tests/native/program.

The formulae are those of docs/scene-format.md, and mostly the add-on's own (addon/wardmis/export/functions.py), which are older
than the renderer's. Inputs are exact in single precision.
"""

import importlib.util
import json
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
specification = importlib.util.spec_from_file_location(
    "functions", HERE.parents[1] / "addon/wardmis/export/functions.py"
)
assert specification and specification.loader
functions = importlib.util.module_from_spec(specification)
specification.loader.exec_module(functions)

random = np.random.default_rng(7)
cases: list[dict[str, Any]] = []

SPECIAL = [0.0, 1.0, -1.0, 0.5, -0.5, 2.0, -2.5, 3.0, 0.25, -0.75]


def number(positive: bool = False) -> float:
    value = random.choice(SPECIAL) if random.random() < 0.5 else random.integers(-200, 200) / 64.0
    return float(np.float32(abs(value) if positive else value))


def vector(positive: bool = False) -> list[float]:
    if random.random() < 0.1:
        return [number(positive)] * 3
    return [number(positive) for _ in range(3)]


def plain(value: Any) -> Any:
    value = np.asarray(value, float)
    numbers = [float(f"{v:.8g}") for v in value.reshape(-1)]
    return numbers[0] if value.size == 1 else numbers


def case(op: str, arguments: list[Any], out: Any, **parameters: Any) -> None:
    out = np.asarray(out, float)
    if np.isfinite(out).all() and np.abs(out).max() < 1e5:
        cases.append({"op": op, "in": arguments, "out": plain(out), **parameters})


def fill(
    op: str, kinds: str, function: Any, times: int = 12, positive: bool = False, scalar: bool = False, **parameters: Any
) -> None:
    """scalar: the function gives three equal numbers for one."""
    for _ in range(times):
        arguments = [number(positive) if kind == "n" else vector(positive) for kind in kinds]
        arrays = [np.asarray(a, float) for a in arguments]
        with np.errstate(all="ignore"):
            out = function(*arrays)
        case(op, arguments, np.asarray(out).reshape(-1)[0] if scalar else out, **parameters)


M = functions.MATH
one = {
    "add": "ADD", "subtract": "SUBTRACT", "multiply": "MULTIPLY", "divide": "DIVIDE", "power": "POWER", "logarithm": "LOGARITHM",
    "minimum": "MINIMUM", "maximum": "MAXIMUM", "less-than": "LESS_THAN", "greater-than": "GREATER_THAN", "modulo": "MODULO",
    "floored-modulo": "FLOORED_MODULO", "snap": "SNAP", "ping-pong": "PINGPONG", "atan2": "ARCTAN2",
}  # fmt: skip
for op, key in one.items():
    fill(op, "nn", M[key])
unary = {
    "sqrt": "SQRT", "inverse-sqrt": "INVERSE_SQRT", "absolute": "ABSOLUTE", "exponent": "EXPONENT", "sign": "SIGN", "round": "ROUND",
    "floor": "FLOOR", "ceil": "CEIL", "truncate": "TRUNC", "fraction": "FRACT", "sin": "SINE", "cos": "COSINE", "tan": "TANGENT",
    "asin": "ARCSINE", "acos": "ARCCOSINE", "atan": "ARCTANGENT", "sinh": "SINH", "cosh": "COSH", "tanh": "TANH",
    "radians": "RADIANS", "degrees": "DEGREES",
}  # fmt: skip
for op, key in unary.items():
    fill(op, "n", M[key])
fill("multiply-add", "nnn", M["MULTIPLY_ADD"])
fill("wrap", "nnn", M["WRAP"])
fill("compare", "nnn", lambda a, b, c: np.abs(a - b) <= max(c, np.finfo(np.float32).eps))


def smooth_minimum(a: Any, b: Any, c: Any) -> Any:
    h = max(c - abs(a - b), 0.0) / c if c != 0 else 0.0
    return min(a, b) - h**3 * c / 6.0


fill("smooth-minimum", "nnn", smooth_minimum)
fill("smooth-maximum", "nnn", lambda a, b, c: -smooth_minimum(-a, -b, c))
fill("clamp", "nnn", lambda a, b, c: np.minimum(np.maximum(a, b), c))
fill("clamp-range", "nnn", functions.clamped_to_range)
fill("mix-number", "nnn", lambda t, a, b: a * (1 - np.clip(t, 0, 1)) + b * np.clip(t, 0, 1))
fill("mix-number", "nnn", lambda t, a, b: a * (1 - t) + b * t, clampFactor=False)


def ranged(key: str) -> Any:
    return lambda v, a, b, c, d: functions.clamped_to_range(functions.map_range(key, False)(v, a, b, c, d), c, d)


for suffix, key in (("", "LINEAR"), ("-smoothstep", "SMOOTHSTEP"), ("-smootherstep", "SMOOTHERSTEP")):
    fill("map-range" + suffix, "nnnnn", functions.map_range(key, False))
    fill("map-range" + suffix, "nnnnn", ranged(key), clamp=True)
fill("map-range-stepped", "nnnnnn", functions.map_range("STEPPED", False))
fill("map-range-stepped", "nnnnnn", functions.map_range("STEPPED", True), clamp=True)

fill("vector", "n", lambda a: np.repeat(a, 3))
for version in (3, 5):
    fill("luminance", "v", lambda a, v=version: functions.luminance(a, v), 6, version=version)
fill("mean", "v", lambda a: a.mean())
for i, op in enumerate("xyz"):
    fill(op, "v", lambda a, i=i: a[i], 4)
fill("combine", "nnn", lambda *a: np.array(a), 4)

V = functions.VECTOR_MATH
for op, key in {"add": "ADD", "subtract": "SUBTRACT", "multiply": "MULTIPLY", "divide": "DIVIDE", "minimum": "MINIMUM",
                "maximum": "MAXIMUM", "modulo": "MODULO", "power": "POWER", "snap": "SNAP", "cross": "CROSS_PRODUCT",
                "project": "PROJECT", "reflect": "REFLECT"}.items():  # fmt: skip
    fill("vector-" + op, "vv", V[key])
for op, key in {"round": "ROUND", "floor": "FLOOR", "ceil": "CEIL", "fraction": "FRACTION", "absolute": "ABSOLUTE", "sign": "SIGN",
                "sin": "SINE", "cos": "COSINE", "tan": "TANGENT", "normalize": "NORMALIZE"}.items():  # fmt: skip
    fill("vector-" + op, "v", V[key])
fill("vector-multiply-add", "vvv", V["MULTIPLY_ADD"])
fill("vector-wrap", "vvv", V["WRAP"])
fill("vector-faceforward", "vvv", V["FACEFORWARD"])
fill("vector-refract", "vvn", V["REFRACT"])
fill("vector-scale", "vn", V["SCALE"])
fill("vector-dot", "vv", V["DOT_PRODUCT"], scalar=True)
fill("vector-distance", "vv", V["DISTANCE"], scalar=True)
fill("vector-length", "v", V["LENGTH"], scalar=True)


def of_vector(key: str, clamp: bool) -> Any:
    def function(v: Any, a: Any, b: Any, c: Any, d: Any, *steps: Any) -> Any:
        mapped = functions.map_range(key, clamp)(v, a, b, c, d, *steps)
        t = functions.STEPS[key](np.zeros(3))
        return np.where(a == b, c + t * (d - c), mapped)

    return function


for suffix, key in (
    ("", "LINEAR"),
    ("-stepped", "STEPPED"),
    ("-smoothstep", "SMOOTHSTEP"),
    ("-smootherstep", "SMOOTHERSTEP"),
):
    for clamp in (False, True):
        fill("vector-map-range" + suffix, "vvvvv" + "v" * (key == "STEPPED"), of_vector(key, clamp), clamp=clamp)
fill("mix-vector", "nvv", lambda t, a, b: a * (1 - np.clip(t, 0, 1)) + b * np.clip(t, 0, 1))
fill("mix-vector-each", "vvv", lambda t, a, b: a * (1 - np.clip(t, 0, 1)) + b * np.clip(t, 0, 1))
fill("mix-vector-each", "vvv", lambda t, a, b: a * (1 - t) + b * t, clampFactor=False)


def rotation(axis: Any, angle: float) -> Any:
    """Rodrigues."""
    n = axis / np.linalg.norm(axis)
    k = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * (k @ k)


def euler(angles: Any) -> Any:
    x, y, z = np.eye(3)
    return rotation(z, angles[2]) @ rotation(y, angles[1]) @ rotation(x, angles[0])


def rotated(v: Any, center: Any, axis: Any, angle: Any) -> Any:
    return v if not axis.any() else rotation(axis, float(angle)) @ (v - center) + center


fill("vector-rotate-axis", "vvvn", rotated)
fill("vector-rotate-axis", "vvvn", lambda v, c, n, a: rotated(v, c, n, -a), invert=True)
fill("vector-rotate-euler", "vvv", lambda v, c, a: euler(a) @ (v - c) + c)
fill("vector-rotate-euler", "vvv", lambda v, c, a: euler(a).T @ (v - c) + c, invert=True)
fill("mapping-point", "vvvv", lambda v, location, a, s: euler(a) @ (v * s) + location)
fill("mapping-texture", "vvvv", lambda v, location, a, s: functions.divide(euler(a).T @ (v - location), s))
fill("mapping-vector", "vvv", lambda v, a, s: euler(a) @ (v * s))
fill("mapping-normal", "vvv", lambda v, a, s: V["NORMALIZE"](euler(a) @ functions.divide(v, s)))
matrix = [float(np.float32(v)) for v in random.normal(size=12)]
fill("mapping", "v", lambda v: np.reshape(matrix, (3, 4)) @ np.append(v, 1.0), matrix=matrix)

BLENDS = {key.lower().replace("_", "-"): function for key, function in functions.BLENDS.items()}
BLENDS["divide"] = lambda t, a, b: np.where(b != 0, (1 - t) * a + t * functions.divide(a, b), a)
for name, blend in BLENDS.items():
    op = "mix" if name == "mix" else "mix-" + name
    for positive in (False, True):
        fill(op, "nvv", lambda t, a, b, f=blend: f(np.clip(t, 0, 1), a, b) if t.ndim else f(np.full(3, np.clip(t, 0, 1)), a, b), positive=positive)  # fmt: skip
    fill(
        op,
        "nvv",
        lambda t, a, b, f=blend: np.clip(f(np.full(3, t), a, b), 0, 1),
        8,
        True,
        clampFactor=False,
        clampResult=True,
    )

fill("rgb-to-hsv", "v", functions.to_hsv, positive=True)
fill("rgb-to-hsl", "v", functions.to_hsl, positive=True)
for _ in range(12):
    hue = [float(np.float32(v)) for v in random.integers(0, 33, 3) / 32]
    case("hsv-to-rgb", [hue], functions.from_hsv(np.array(hue)))
    case("hsl-to-rgb", [hue], functions.from_hsl(np.array(hue)))
fill(
    "hue-saturation",
    "nnnnv",
    lambda h, s, v, t, c: functions.adjusted(*(np.full(3, x) for x in (h, s, v, t)), c),
    positive=True,
)
fill("bright-contrast", "vnn", functions.brightened)
fill("gamma", "vn", lambda c, g: np.ones(3) if g == 0 else functions.gamma(c, g))
fill("invert", "nv", lambda t, c: t * (1 - c) + (1 - t) * c)

colors = [[float(np.float32(v)) for v in row] for row in random.random((7, 4))]
steps = np.linspace(0, 1, 7)
fill("ramp", "n", lambda t: [np.interp(t, steps, np.array(colors)[:, k]) for k in range(3)], table=colors)
fill("ramp-alpha", "n", lambda t: np.interp(t, steps, np.array(colors)[:, 3]), table=colors)
fill("ramp", "n", lambda t: colors[int(np.clip(t, 0, 1) * 6)][:3], table=colors, interpolate=False)


def extended(p: Any, column: Any) -> Any:
    n = len(column) - 1
    below, above = column[0] + (column[1] - column[0]) * p * n, column[-1] + (column[-1] - column[-2]) * (p - 1) * n
    return below if p < 0 else above if p > 1 else np.interp(p, np.linspace(0, 1, n + 1), column)


RANGE: dict[str, Any] = {"from": -1.0, "to": 2.0}
table = [row[:3] for row in colors]
place = lambda a: (a + 1.0) / 3.0  # noqa: E731
fill("curves", "nv", lambda t, c: [(1 - t) * a + t * extended(place(a), np.array(table)[:, k]) for k, a in enumerate(c)],
     table=table, **RANGE)  # fmt: skip
fill("curve", "nn", lambda t, a: (1 - t) * a + t * extended(place(a), np.array(table)[:, 0]),
     table=[row[0] for row in table], **RANGE)  # fmt: skip
fill("curve", "nn", lambda t, a: (1 - t) * a + t * np.interp(place(a), steps, np.array(table)[:, 0]),
     table=[row[0] for row in table], extrapolate=False, **RANGE)  # fmt: skip

text = ",\n".join(json.dumps(c) for c in cases)
(HERE / "operations.json").write_text(f"[\n{text}\n]\n")
print(len(cases), "cases of", len({c["op"] for c in cases}), "operations")
