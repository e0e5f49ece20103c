# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's nodes compute of numbers and colours, as Cycles does: functions of arrays (..., 3).

A number is a grey colour. Nothing here divides by zero or takes a root of less.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

Function = Callable[..., Any]


def luminance(c: Any, version: int = 5) -> Any:
    """(...), of linear Rec. 709, with the digits that Cycles has: of 5 those of the primaries."""
    return c @ np.array((0.212639, 0.7151687, 0.0721923) if version >= 5 else (0.2126729, 0.7151522, 0.072175))


def divide(a: Any, b: Any) -> Any:
    a, b = np.broadcast_arrays(a, b)
    return np.divide(a, b, out=np.zeros(a.shape, np.result_type(a, b, np.float32)), where=b != 0)


def power(a: Any, b: Any) -> Any:
    a, b = np.broadcast_arrays(np.asarray(a, float), np.asarray(b, float))
    defined = ((a > 0) | ((a < 0) & (b == np.trunc(b)))) & (b != 0)
    return np.where(b == 0, 1.0, np.power(np.where(defined, a, 1.0), b) * defined)


def _wrap(value: Any, most: Any, least: Any) -> Any:
    width = most - least
    return np.where(width != 0, value - width * np.floor(divide(value - least, width)), least)


def _logarithm(a: Any, b: Any) -> Any:
    defined = (a > 0) & (b > 0)
    return divide(np.log(np.where(defined, a, 1.0)), np.log(np.where(defined, b, 1.0)))


def _smooth_minimum(a: Any, b: Any, width: Any) -> Any:
    h = divide(np.maximum(width - np.abs(a - b), 0.0), width)
    return np.minimum(a, b) - h**3 * width / 6.0


def _floored_modulo(a: Any, b: Any) -> Any:
    return np.where(b != 0, a - np.floor(divide(a, b)) * b, 0.0)


def _modulo(a: Any, b: Any) -> Any:
    return np.where(b != 0, np.fmod(a, np.where(b != 0, b, 1.0)), 0.0)


def _fraction(a: Any) -> Any:
    return a - np.floor(a)


def _ping_pong(a: Any, b: Any) -> Any:
    return np.where(b != 0, np.abs(_fraction(divide(a - b, 2.0 * b)) * 2.0 * b - b), 0.0)


MATH: dict[str, Function] = {
    "ADD": np.add,
    "SUBTRACT": np.subtract,
    "MULTIPLY": np.multiply,
    "DIVIDE": divide,
    "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "POWER": power,
    "LOGARITHM": _logarithm,
    "SQRT": lambda a: np.sqrt(np.maximum(a, 0.0)),
    "INVERSE_SQRT": lambda a: divide(1.0, np.sqrt(np.maximum(a, 0.0))),
    "ABSOLUTE": np.abs,
    "EXPONENT": np.exp,
    "MINIMUM": np.minimum,
    "MAXIMUM": np.maximum,
    "LESS_THAN": lambda a, b: (a < b) * 1.0,
    "GREATER_THAN": lambda a, b: (a > b) * 1.0,
    "SIGN": np.sign,
    "COMPARE": lambda a, b, c: (np.abs(a - b) <= np.maximum(c, 1e-5)) * 1.0,
    "SMOOTH_MIN": _smooth_minimum,
    "SMOOTH_MAX": lambda a, b, c: -_smooth_minimum(-a, -b, c),
    "ROUND": lambda a: np.floor(a + 0.5),
    "FLOOR": np.floor,
    "CEIL": np.ceil,
    "TRUNC": np.trunc,
    "FRACT": _fraction,
    "MODULO": _modulo,
    "FLOORED_MODULO": _floored_modulo,
    "WRAP": _wrap,
    "SNAP": lambda a, b: np.floor(divide(a, b)) * b,
    "PINGPONG": _ping_pong,
    "SINE": np.sin,
    "COSINE": np.cos,
    "TANGENT": np.tan,
    "ARCSINE": lambda a: np.arcsin(np.clip(a, -1.0, 1.0)),
    "ARCCOSINE": lambda a: np.arccos(np.clip(a, -1.0, 1.0)),
    "ARCTANGENT": np.arctan,
    "ARCTAN2": np.arctan2,
    "SINH": np.sinh,
    "COSH": np.cosh,
    "TANH": np.tanh,
    "RADIANS": np.radians,
    "DEGREES": np.degrees,
}


# ---- vectors -------------------------------------------------------------------------------------------------------


def _dot(a: Any, b: Any) -> Any:
    return np.repeat((a * b).sum(-1, keepdims=True), 3, axis=-1)


def _length(a: Any) -> Any:
    return np.sqrt(_dot(a, a))


def _unit(a: Any) -> Any:
    return divide(a, _length(a))


def _cross(a: Any, b: Any) -> Any:
    a, b = np.broadcast_arrays(a, b)
    return np.cross(a, b)


def _reflect(a: Any, b: Any) -> Any:
    n = _unit(b)
    return a - 2.0 * n * _dot(a, n)


def _refract(a: Any, b: Any, eta: Any) -> Any:
    n = _unit(b)
    cosine = _dot(n, a)
    k = 1.0 - eta * eta * (1.0 - cosine * cosine)
    return np.where(k < 0, 0.0, eta * a - (eta * cosine + np.sqrt(np.maximum(k, 0.0))) * n)


VECTOR_MATH: dict[str, Function] = {
    **{
        name: MATH[name]
        for name in [
            "ADD",
            "SUBTRACT",
            "MULTIPLY",
            "DIVIDE",
            "MULTIPLY_ADD",
            "MINIMUM",
            "MAXIMUM",
            "FLOOR",
            "CEIL",
            "MODULO",
            "WRAP",
            "SNAP",
        ]
    },
    **{name: MATH[name] for name in ["SINE", "COSINE", "TANGENT", "POWER", "SIGN", "ROUND", "ABSOLUTE"]},
    "FRACTION": _fraction,
    "CROSS_PRODUCT": _cross,
    "PROJECT": lambda a, b: divide(_dot(a, b), _dot(b, b)) * b,
    "REFLECT": _reflect,
    "REFRACT": _refract,
    "FACEFORWARD": lambda a, b, c: np.where(_dot(c, b) < 0, a, -a),
    "DOT_PRODUCT": _dot,
    "DISTANCE": lambda a, b: _length(a - b),
    "LENGTH": _length,
    "SCALE": np.multiply,
    "NORMALIZE": _unit,
}


# ---- colours -------------------------------------------------------------------------------------------------------


def to_hsv(c: Any) -> Any:
    most, least = c.max(-1), c.min(-1)
    span = most - least
    saturation = divide(span, most)
    r, g, b = (divide(most - c[..., i], span) for i in range(3))
    hue = np.where(c[..., 0] == most, b - g, np.where(c[..., 1] == most, 2.0 + r - b, 4.0 + g - r)) / 6.0
    hue = np.where(saturation == 0, 0.0, hue)
    return np.stack([hue + (hue < 0), saturation, most], axis=-1)


def from_hsv(c: Any) -> Any:
    hue, saturation, value = c[..., :1], c[..., 1:2], c[..., 2:3]
    # each channel is full within a third of the circle of hues, and falls on both sides
    away = np.abs(np.mod(hue * 6.0 + np.array((0.0, 4.0, 2.0)), 6.0) - 3.0)
    return value * (1.0 - saturation * (1.0 - np.clip(away - 1.0, 0.0, 1.0)))


def to_hsl(c: Any) -> Any:
    most, least = c.max(-1), c.min(-1)
    lightness = np.minimum(1.0, (most + least) / 2.0)
    span = most - least
    saturation = divide(span, np.where(lightness > 0.5, 2.0 - most - least, most + least))
    return np.stack([to_hsv(c)[..., 0], saturation, lightness], axis=-1)


def from_hsl(c: Any) -> Any:
    saturated = from_hsv(np.stack([c[..., 0], np.ones_like(c[..., 0]), np.ones_like(c[..., 0])], axis=-1))
    chroma = (1.0 - np.abs(2.0 * c[..., 2:3] - 1.0)) * c[..., 1:2]
    return (saturated - 0.5) * chroma + c[..., 2:3]


def adjusted(hue: Any, saturation: Any, value: Any, share: Any, color: Any) -> Any:
    """Of a Hue/Saturation/Value node."""
    h, s, v = np.moveaxis(to_hsv(color), -1, 0)
    turned = np.stack(
        np.broadcast_arrays(
            np.mod(h + hue[..., 0] + 0.5, 1.0), np.clip(s * saturation[..., 0], 0.0, 1.0), v * value[..., 0]
        ),
        axis=-1,
    )
    return np.maximum(color + share * (from_hsv(turned) - color), 0.0)


def _with_hsv(a: Any, b: Any, parts: tuple[int, ...]) -> Any:
    """`a` with these of hue, saturation and value from `b`; as it is where that has no hue to give."""
    a, b = np.broadcast_arrays(a, b)
    of_b = to_hsv(b)
    mixed = to_hsv(a)
    for part in parts:
        mixed[..., part] = of_b[..., part]
    return np.where(of_b[..., 1:2] != 0, from_hsv(mixed), a)


def _mix_hsv_part(t: Any, a: Any, b: Any, part: int) -> Any:
    a, b = np.broadcast_arrays(a, b)
    hsv, of_b = to_hsv(a), to_hsv(b)
    changed = hsv.copy()
    changed[..., part] += t[..., 0] * (of_b[..., part] - hsv[..., part])
    return from_hsv(changed) if part == 2 else np.where(hsv[..., 1:2] != 0, from_hsv(changed), a)


def _burn(t: Any, a: Any, b: Any) -> Any:
    divisor = 1.0 - t + t * b
    return np.where(divisor <= 0, 0.0, np.clip(1.0 - divide(1.0 - a, divisor), 0.0, 1.0))


def _dodge(t: Any, a: Any, b: Any) -> Any:
    divisor = 1.0 - t * b
    return np.where(a == 0, 0.0, np.where(divisor <= 0, 1.0, np.minimum(divide(a, divisor), 1.0)))


def _overlay(t: Any, a: Any, b: Any) -> Any:
    return np.where(a < 0.5, a * (1.0 - t + 2.0 * t * b), 1.0 - (1.0 - t + 2.0 * t * (1.0 - b)) * (1.0 - a))


def _soft_light(t: Any, a: Any, b: Any) -> Any:
    screen = 1.0 - (1.0 - b) * (1.0 - a)
    return (1.0 - t) * a + t * ((1.0 - a) * b * a + a * screen)


def _mixed(function: Function) -> Function:
    return lambda t, a, b: a + t * (function(a, b) - a)


# of (factor, a, b)
BLENDS: dict[str, Function] = {
    "MIX": _mixed(lambda a, b: b),
    "DARKEN": _mixed(np.minimum),
    "MULTIPLY": _mixed(np.multiply),
    "BURN": _burn,
    "LIGHTEN": _mixed(np.maximum),
    "SCREEN": _mixed(lambda a, b: 1.0 - (1.0 - a) * (1.0 - b)),
    "DODGE": _dodge,
    "ADD": _mixed(np.add),
    "OVERLAY": _overlay,
    "SOFT_LIGHT": _soft_light,
    "LINEAR_LIGHT": lambda t, a, b: a + t * (2.0 * b - 1.0),
    "DIFFERENCE": _mixed(lambda a, b: np.abs(a - b)),
    "EXCLUSION": lambda t, a, b: np.maximum(a + t * (b - 2.0 * a * b), 0.0),
    "SUBTRACT": _mixed(np.subtract),
    "DIVIDE": lambda t, a, b: np.where(b != 0, (1.0 - t) * a + t * divide(a, b), a),
    "HUE": _mixed(lambda a, b: _with_hsv(a, b, (0,))),
    "SATURATION": lambda t, a, b: _mix_hsv_part(t, a, b, 1),
    "COLOR": _mixed(lambda a, b: _with_hsv(a, b, (0, 1))),
    "VALUE": lambda t, a, b: _mix_hsv_part(t, a, b, 2),
}


def gamma(c: Any, exponent: Any) -> Any:
    """What is negative stays as it is."""
    return np.where(c > 0, power(np.maximum(c, 0.0), exponent), c)


def brightened(c: Any, bright: Any, contrast: Any) -> Any:
    return np.maximum((1.0 + contrast) * c + bright - contrast * 0.5, 0.0)


# ---- ranges --------------------------------------------------------------------------------------------------------


def clamped(value: Any, least: Any, most: Any) -> Any:
    return np.minimum(np.maximum(value, least), most)


def clamped_to_range(value: Any, a: Any, b: Any) -> Any:
    return clamped(value, np.minimum(a, b), np.maximum(a, b))


def _linear(x: Any) -> Any:
    return x


def _smoothstep(x: Any) -> Any:
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def _smootherstep(x: Any) -> Any:
    x = np.clip(x, 0.0, 1.0)
    return x**3 * (x * (x * 6.0 - 15.0) + 10.0)


STEPS = {"LINEAR": _linear, "STEPPED": _linear, "SMOOTHSTEP": _smoothstep, "SMOOTHERSTEP": _smootherstep}


def map_range(interpolation: str, clamp: bool) -> Function:
    """Of (value, from least, from most, to least, to most, [steps])."""

    def function(value: Any, a: Any, b: Any, c: Any, d: Any, *steps: Any) -> Any:
        x = STEPS[interpolation](divide(value - a, b - a))
        if steps:
            x = np.where(steps[0] > 0, divide(np.floor(x * (steps[0] + 1.0)), steps[0]), 0.0)
        mapped = np.where(a == b, 0.0, c + x * (d - c))
        return clamped_to_range(mapped, c, d) if clamp and interpolation in {"LINEAR", "STEPPED"} else mapped

    return function
