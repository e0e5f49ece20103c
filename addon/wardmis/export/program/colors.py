# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of numbers and colours."""

from __future__ import annotations

from typing import Any

from ... import compat
from ..tree import NodeUse
from .builder import Value
from .folds import BLENDS, MATH, RANGES
from .reader import Reader


def _math(use: NodeUse, _output: Any, p: Reader) -> Value | None:
    name = MATH.get(use.node.operation)
    if name is None:
        return None
    value = p(name, *p.inputs(use))
    return p("clamp", value, 0.0, 1.0) if use.node.use_clamp else value


def _mix_rgb(use: NodeUse, _output: Any, p: Reader) -> Value | None:
    name = BLENDS.get(use.node.blend_type)
    return None if name is None else p(name, *p.inputs(use), **_clamps(True, use.node.use_clamp))


def _mix(use: NodeUse, _output: Any, p: Reader) -> Value | None:
    node = use.node
    if node.data_type == "RGBA":
        name = BLENDS.get(node.blend_type)
        return None if name is None else p(name, *p.inputs(use), **_clamps(node.clamp_factor, node.clamp_result))
    names = {"FLOAT": "mix-number", "VECTOR": "mix-vector" if node.factor_mode == "UNIFORM" else "mix-vector-each"}
    name = names.get(node.data_type)
    return None if name is None else p(name, *p.inputs(use), **_clamps(node.clamp_factor, False))


def _clamps(factor: bool, result: bool) -> dict[str, bool]:
    """What differs from the defaults."""
    return ({} if factor else {"clampFactor": False}) | ({"clampResult": True} if result else {})


def _simple(name: str, **parameters: Any) -> Any:
    """A node that is an operation of its inputs in their order."""
    return lambda use, _output, p: p(name, *p.inputs(use), **parameters)


def _ramp(use: NodeUse, output: Any, p: Reader) -> Value:
    ramp = use.node.color_ramp
    table = tuple(tuple(ramp.evaluate(i / compat.RAMP_STEPS)) for i in range(compat.RAMP_STEPS + 1))
    name = "ramp-alpha" if output.name == "Alpha" else "ramp"
    parameters = {"interpolate": False} if ramp.interpolation == "CONSTANT" else {}
    return p(name, p.read(use, 0), table=table, **parameters)


def curve_table(mapping: Any, columns: list[int], count: int, common: int | None = None) -> dict[str, Any]:
    """The parameters of an operation that looks these curves up, after the `common` one. The first `count` curves say from where to where."""
    mapping.initialize()
    curves = [mapping.curves[i] for i in range(count)]
    start = min(curve.points[0].location[0] for curve in curves)
    end = max(curve.points[len(curve.points) - 1].location[0] for curve in curves)

    def value(column: int, x: float) -> float:
        return float(
            mapping.evaluate(
                mapping.curves[column], x if common is None else mapping.evaluate(mapping.curves[common], x)
            )
        )

    places = [start + i / compat.RAMP_STEPS * (end - start) for i in range(compat.RAMP_STEPS + 1)]
    rows = [tuple(value(column, x) for column in columns) for x in places]
    table = tuple(rows) if len(columns) > 1 else tuple(row[0] for row in rows)
    return {"table": table, "from": start, "to": end, "extrapolate": mapping.extend == "EXTRAPOLATED"}


def _rgb_curve(use: NodeUse, _output: Any, p: Reader) -> Value:
    return p("curves", p.read(use, 0), p.read(use, 1), **curve_table(use.node.mapping, [0, 1, 2], 4, common=3))


def _float_curve(use: NodeUse, _output: Any, p: Reader) -> Value:
    return p("curve", p.read(use, 0), p.read(use, 1), **curve_table(use.node.mapping, [0], 1))


def _map_range(use: NodeUse, _output: Any, p: Reader) -> Value:
    node = use.node
    name = RANGES[node.interpolation_type]
    if node.data_type == "FLOAT_VECTOR":
        name = f"vector-{name}"
    clamp = {"clamp": True} if node.clamp and node.interpolation_type in {"LINEAR", "STEPPED"} else {}
    return p(name, *p.inputs(use), **clamp)


def _clamp(use: NodeUse, _output: Any, p: Reader) -> Value:
    return p("clamp-range" if use.node.clamp_type == "RANGE" else "clamp", *p.inputs(use))


def _mode(node: Any, kind: str) -> str:
    return getattr(node, "mode", "HSV" if node.bl_idname == f"ShaderNode{kind}HSV" else "RGB")  # type: ignore[no-any-return]


def _separate(use: NodeUse, output: Any, p: Reader) -> Value:
    mode, color = _mode(use.node, "Separate"), p.read(use, 0)
    if mode != "RGB":
        color = p(f"rgb-to-{mode.lower()}", color)
    return p("xyz"[list(use.node.outputs).index(output)], color)


def _combine(use: NodeUse, _output: Any, p: Reader) -> Value:
    mode, color = _mode(use.node, "Combine"), p("combine", *p.inputs(use))
    return color if mode == "RGB" else p(f"{mode.lower()}-to-rgb", color)


NODES = {
    "Math": _math,
    "Mix": _mix,
    "MixRGB": _mix_rgb,
    "Gamma": _simple("gamma"),
    "Invert": _simple("invert"),
    "BrightContrast": _simple("bright-contrast"),
    "HueSaturation": _simple("hue-saturation", version=compat.CYCLES),
    "RGBCurve": _rgb_curve,
    "FloatCurve": _float_curve,
    "ValToRGB": _ramp,
    "MapRange": _map_range,
    "Clamp": _clamp,
    "RGBToBW": _simple("luminance", version=compat.CYCLES),
    "SeparateColor": _separate,
    "SeparateRGB": _separate,
    "SeparateHSV": _separate,
    "SeparateXYZ": _separate,
    "CombineColor": _combine,
    "CombineRGB": _combine,
    "CombineHSV": _combine,
    "CombineXYZ": _combine,
    "Blackbody": _simple("blackbody", version=compat.CYCLES),
    "Wavelength": _simple("wavelength", version=compat.CYCLES),
}
