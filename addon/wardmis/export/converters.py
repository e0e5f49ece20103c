# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of colours and numbers that are rendered as Cycles renders them."""

from __future__ import annotations

from collections.abc import Callable
from hashlib import sha256
from typing import Any

import bpy
import numpy as np

from . import functions as f
from . import neutral
from .read import CONVERTERS, NEUTRAL, own_value, read
from .spectrum import blackbody, wavelength
from .texture import environment_texture, image_texture
from .tree import NodeUse
from .value import Value, calculator, constant


def _inputs(use: NodeUse) -> list[Value]:
    """Of the inputs in use: of each name some nodes have one socket per data type, all but one disabled."""
    return [read(use, i) for i, socket in enumerate(use.node.inputs) if socket.enabled]


def _math(use: NodeUse, _output: Any) -> Value | None:
    return _operation(use, f.MATH, use.node.use_clamp)


def _vector_math(use: NodeUse, _output: Any) -> Value | None:
    return _operation(use, f.VECTOR_MATH, False)


def _operation(use: NodeUse, operations: dict[str, f.Function], clamp: bool) -> Value | None:
    function = operations.get(use.node.operation)
    if function is None:
        return None
    value = calculator(use).apply(f"{use.node.bl_idname} {use.node.operation}", function, *_inputs(use))
    return calculator(use).clamp(value) if clamp else value


def _blend(use: NodeUse, factor: Value, a: Value, b: Value, blend: str, clamp_result: bool) -> Value | None:
    function = f.BLENDS.get(blend)
    if function is None:
        return None
    blended = calculator(use).apply(blend, function, factor, a, b)
    return calculator(use).clamp(blended) if clamp_result else blended


def _mix_rgb(use: NodeUse, _output: Any) -> Value | None:
    factor, a, b = _inputs(use)
    return _blend(use, calculator(use).clamp(factor), a, b, use.node.blend_type, use.node.use_clamp)


def _mix(use: NodeUse, _output: Any) -> Value | None:
    node = use.node
    if node.data_type not in {"FLOAT", "VECTOR", "RGBA"}:
        return None
    factor, a, b = _inputs(use)
    if node.clamp_factor:
        factor = calculator(use).clamp(factor)
    if node.data_type == "RGBA":
        return _blend(use, factor, a, b, node.blend_type, node.clamp_result)
    return _blend(use, factor, a, b, "MIX", False)


def _applied(name: str, function: f.Function) -> Callable[[NodeUse, Any], Value]:
    """A node whose function takes its inputs in their order."""
    return lambda use, _output: calculator(use).apply(name, function, *_inputs(use))


def _ramp(use: NodeUse, output: Any) -> Value:
    """Blender evaluates a ramp one colour at a time, so texels look it up in a table."""
    steps = np.linspace(0.0, 1.0, 1025)
    ramp = use.node.color_ramp
    table = np.array([ramp.evaluate(step) for step in steps])
    if output.name == "Alpha":
        table[:, :3] = table[:, 3:]
    if ramp.interpolation == "CONSTANT":

        def function(x: np.ndarray) -> np.ndarray:
            return table[np.clip(x[..., 0] * 1024.0, 0.0, 1024.0).astype(int), :3]

    else:
        function = _table(steps, table)
    return calculator(use).apply(f"ramp {ramp.interpolation} {_digest(table)}", function, read(use, 0))


def _table(steps: np.ndarray, table: np.ndarray) -> f.Function:
    """Of each channel its column, or of all the only one."""
    columns = [table[:, i] for i in range(3)] if table.ndim > 1 else [table] * 3
    return lambda x: np.stack([np.interp(x[..., 0], steps, column) for column in columns], axis=-1)


def _digest(table: np.ndarray) -> str:
    return sha256(table.tobytes()).hexdigest()


# where curves are sampled: beyond 0 and 1 they are extended
CURVE_STEPS = np.linspace(-1.0, 3.0, 4 * 512 + 1)


def _curve(mapping: Any, index: int) -> np.ndarray:
    mapping.initialize()
    curve = mapping.curves[index]
    return np.array([mapping.evaluate(curve, step) for step in CURVE_STEPS])


def _rgb_curve(use: NodeUse, _output: Any) -> Value:
    mapping = use.node.mapping
    common = _curve(mapping, 3)
    tables = [np.interp(common, CURVE_STEPS, _curve(mapping, i)) for i in range(3)]

    def function(share: np.ndarray, color: np.ndarray) -> np.ndarray:
        channels = [np.interp(color[..., i], CURVE_STEPS, table) for i, table in enumerate(tables)]
        return color + share * (np.stack(channels, axis=-1) - color)

    return calculator(use).apply(f"curves {_digest(np.array(tables))}", function, read(use, 0), read(use, 1))


def _float_curve(use: NodeUse, _output: Any) -> Value:
    table = _curve(use.node.mapping, 0)
    looked_up = _table(CURVE_STEPS, table)
    name = f"curve {_digest(table)}"
    return calculator(use).apply(name, lambda t, x: x + t * (looked_up(x) - x), read(use, 0), read(use, 1))


MODES: dict[str, tuple[f.Function, f.Function]] = {
    "RGB": (lambda c: c, lambda c: c),
    "HSV": (f.to_hsv, f.from_hsv),
    "HSL": (f.to_hsl, f.from_hsl),
}


def _separate(use: NodeUse, output: Any) -> Value:
    mode = getattr(use.node, "mode", "HSV" if use.node.bl_idname == "ShaderNodeSeparateHSV" else "RGB")
    split, _ = MODES[mode]
    channel = list(use.node.outputs).index(output)
    name = f"channel {channel} of {mode}"
    return calculator(use).apply(name, lambda c: np.repeat(split(c)[..., channel, None], 3, axis=-1), read(use, 0))


def _combine(use: NodeUse, _output: Any) -> Value:
    mode = getattr(use.node, "mode", "HSV" if use.node.bl_idname == "ShaderNodeCombineHSV" else "RGB")
    _, join = MODES[mode]

    def function(r: np.ndarray, g: np.ndarray, b: np.ndarray) -> np.ndarray:
        return join(np.stack(np.broadcast_arrays(r[..., 0], g[..., 0], b[..., 0]), axis=-1))

    return calculator(use).apply(f"combine {mode}", function, *_inputs(use))


def _map_range(use: NodeUse, _output: Any) -> Value:
    node = use.node
    clamp = node.clamp
    name = f"map range {node.interpolation_type} {clamp}"
    return calculator(use).apply(name, f.map_range(node.interpolation_type, clamp), *_inputs(use))


def _clamp(use: NodeUse, _output: Any) -> Value:
    function = f.clamped_to_range if use.node.clamp_type == "RANGE" else f.clamped
    return calculator(use).apply(f"clamp {use.node.clamp_type}", function, *_inputs(use))


def _spectral(function: Callable[[float], tuple[float, float, float]]) -> Callable[[NodeUse, Any], Value]:
    """A colour of one number."""

    def convert(use: NodeUse, _output: Any) -> Value:
        number = read(use, 0)
        if number.lookup is not None:
            use.note("needs a constant; the mean of the texture is used instead")
        return constant(function(float(number.mean().factor[0])))

    return convert


def _light_falloff(use: NodeUse, output: Any) -> Value | None:
    """Light falls off with the square of the distance; nothing else is possible here."""
    if output.name != "Quadratic":
        return None
    if not read(use, "Smooth").is_black:
        use.note("smooths its falloff, which is not supported; its light is brighter near the lamp")
    return read(use, "Strength")


WITHOUT_IES = 100.0  # what Cycles has instead of a file
MOST_OF_IES = 1 << 20  # bytes, within which the first keyword stands


def has_ies_file(node: Any) -> bool:
    """Whether an IES node has what Cycles reads as a file."""
    if node.mode == "INTERNAL":
        text = "" if node.ies is None else node.ies.as_string()
    else:
        try:
            with open(bpy.path.abspath(node.filepath), encoding="latin-1") as file:
                text = file.read(MOST_OF_IES)
        except OSError:
            text = ""
    return "\nTILT=" in text


def _ies(use: NodeUse, _output: Any) -> Value | None:
    """None: what a file says depends on the direction."""
    if has_ies_file(use.node):
        return None
    use.note("has no IES file; its strength counts a hundredfold, as in Cycles")
    return calculator(use).multiply(read(use, "Strength"), constant(WITHOUT_IES))


def _light_path(use: NodeUse, output: Any) -> Value | None:
    """Of a world, what is known of the kind of ray that sees it."""
    ray = use.owner.ray
    known = {
        "Is Camera Ray": ray == "camera",
        "Is Diffuse Ray": ray == "diffuse",
        "Is Glossy Ray": ray in ("glossy", "transmission"),  # what glass lets pass is both
        "Is Reflection Ray": ray in ("diffuse", "glossy"),
        "Is Shadow Ray": False,
        "Is Transmission Ray": ray == "transmission",
        "Is Volume Scatter Ray": False,
    }
    return None if ray is None or output.name not in known else constant(float(known[output.name]))


def _invert(share: np.ndarray, color: np.ndarray) -> np.ndarray:
    return color + share * (1.0 - 2.0 * color)


def _own_output(use: NodeUse, output: Any) -> Value:
    return own_value(use, output)


CONVERTERS.update(
    {
        "ShaderNodeRGB": _own_output,
        "ShaderNodeValue": _own_output,
        "ShaderNodeTexImage": image_texture,
        "ShaderNodeTexEnvironment": environment_texture,
        "ShaderNodeMath": _math,
        "ShaderNodeVectorMath": _vector_math,
        "ShaderNodeMix": _mix,
        "ShaderNodeMixRGB": _mix_rgb,
        "ShaderNodeGamma": _applied("gamma", f.gamma),
        "ShaderNodeInvert": _applied("invert", _invert),
        "ShaderNodeBrightContrast": _applied("bright", f.brightened),
        "ShaderNodeHueSaturation": _applied("hue", f.adjusted),
        "ShaderNodeRGBCurve": _rgb_curve,
        "ShaderNodeFloatCurve": _float_curve,
        "ShaderNodeValToRGB": _ramp,
        "ShaderNodeMapRange": _map_range,
        "ShaderNodeClamp": _clamp,
        "ShaderNodeRGBToBW": lambda use, _output: calculator(use).grey(read(use, 0)),
        "ShaderNodeSeparateColor": _separate,
        "ShaderNodeSeparateRGB": _separate,
        "ShaderNodeSeparateHSV": _separate,
        "ShaderNodeSeparateXYZ": _separate,
        "ShaderNodeCombineColor": _combine,
        "ShaderNodeCombineRGB": _combine,
        "ShaderNodeCombineHSV": _combine,
        "ShaderNodeCombineXYZ": _combine,
        "ShaderNodeLightFalloff": _light_falloff,
        "ShaderNodeTexIES": _ies,
        "ShaderNodeLightPath": _light_path,
        "ShaderNodeBlackbody": _spectral(blackbody),
        "ShaderNodeWavelength": _spectral(wavelength),
    }
)
NEUTRAL.update(neutral.NEUTRAL)
