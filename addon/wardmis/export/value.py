# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours and numbers of a material: a constant, or a texture after functions that see one texel at a time.

The same numpy functions work on a constant and on all texels of an image, so a texture behind a Gamma or a Math node is
baked once instead of being left out. Everything is RGB: a number is a grey colour.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from mathutils import Euler, Matrix

from .context import ExportContext
from .emission import MISSING
from .image import BakedImage, deviations, missing, texels
from .model import ColorInput, ScalarInput, TextureUse
from .tree import MUTED, NodeUse, place

LUMINANCE = np.array((0.2126, 0.7152, 0.0722))  # of linear Rec. 709

Function = Callable[..., Any]  # of arrays (..., 3) to one


class NotFinite(Exception):
    """A number in the material is NaN or infinite, and has been named in a note."""


@dataclass(frozen=True)
class Lookup:
    """Which texel: two values with equal look-ups see the same one."""

    image: Any
    interpolation: str
    extension: str
    transform: tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class Value:
    """`factor`, with a look-up times its RGB or what `function` makes of its RGBA, called `recipe` to tell functions apart."""

    factor: np.ndarray
    lookup: Lookup | None = None
    function: Function | None = None
    recipe: str = ""

    def of(self, texel: np.ndarray) -> np.ndarray:
        if self.lookup is None:
            return self.factor
        return self.factor.astype(np.float32) * (self.function(texel) if self.function else texel[..., :3])

    def mean(self) -> Value:
        if self.lookup is None:
            return self
        return Value(self.of(texels(self.lookup.image)).reshape(-1, 3).mean(axis=0, dtype=float))

    @property
    def is_black(self) -> bool:
        return not self.factor.any()

    def __str__(self) -> str:
        return f"{self.factor.tolist()} {self.recipe}"


def constant(value: Any) -> Value:
    """Of a number, an RGB or an RGBA."""
    return Value(np.broadcast_to(np.atleast_1d(np.array(value, float))[:3], 3))


BLACK = constant(0.0)


@dataclass(frozen=True)
class Calculator:
    """Arithmetic with values, and whom to tell what it cannot do."""

    material: str
    context: ExportContext

    def apply(self, name: str, function: Function, *values: Value) -> Value:
        """function(*values) per texel. Only one texture can be looked up at a time: others count with their mean."""
        lookups = {value.lookup for value in values if value.lookup is not None}
        if not lookups:
            return Value(function(*(value.factor for value in values)))
        if len(lookups) > 1:
            kept = next(value.lookup for value in values if value.lookup is not None)
            self.context.note(
                f"{place(self.material, self.context)}: several textures are combined; only '{kept.image.name}' is kept, "
                "the others are replaced by their mean"
            )
            values = tuple(value if value.lookup == kept else value.mean() for value in values)
            lookups = {kept}
        recipe = f"{name}({', '.join(map(str, values))})"
        return Value(np.ones(3), lookups.pop(), lambda t: function(*(value.of(t) for value in values)), recipe)

    def add(self, a: Value, b: Value) -> Value:
        if a.is_black or b.is_black:
            return b if a.is_black else a
        return self.apply("add", np.add, a, b)

    def multiply(self, a: Value, b: Value) -> Value:
        """A constant factor needs no new image."""
        if a.lookup is None or b.lookup is None:
            textured = b if a.lookup is None else a
            return Value(a.factor * b.factor, textured.lookup, textured.function, textured.recipe)
        return self.apply("multiply", np.multiply, a, b)

    def complement(self, a: Value) -> Value:
        return self.apply("complement", lambda x: 1.0 - x, a)

    def grey(self, a: Value) -> Value:
        return self.apply("grey", grey, a)

    def color_input(self, a: Value) -> ColorInput:
        r, g, b = (float(x) for x in np.maximum(a.factor, 0.0))  # a NaN stays one
        return ColorInput((r, g, b), self._texture(a, 3) if a.lookup and not a.is_black else None)

    def scalar_input(self, a: Value) -> ScalarInput:
        a = self.grey(a)
        return ScalarInput(float(np.maximum(a.factor[0], 0.0)), self._texture(a, 1) if a.lookup else None)

    def _texture(self, a: Value, channels: int) -> TextureUse:
        assert a.lookup is not None
        image, function = a.lookup.image, a.function
        if function is not None:
            source = image

            def bake() -> np.ndarray:
                return np.maximum(function(texels(source)), 0.0)[..., :channels].astype(np.float32)

            image = BakedImage(f"{image.name} (baked)", f"{image.name_full}: {a.recipe}, {channels}", bake)
        index = self.context.texture(image, a.lookup.interpolation, a.lookup.extension)
        return TextureUse(index, transform=a.lookup.transform)


# ---- the nodes -----------------------------------------------------------------------------------------------------


def read(use: NodeUse, key: str | int) -> Value:
    """What an input socket receives."""
    output, origin = use.origin(key)
    if origin is None:
        return BLACK if output is MUTED else _own_value(use, output)
    converter = CONVERTERS.get(origin.node.bl_idname)
    value = converter(origin, output) if converter else None
    if value is not None:
        # Blender's implicit conversion of a colour to a number
        return calculator(use).grey(value) if use.node.inputs[key].type == "VALUE" else value
    socket = use.node.inputs[key]
    origin.note(f"is not supported as a colour or number; the constant of input '{socket.name}' is used instead")
    return _own_value(use, socket)


def read_number(use: NodeUse, key: str | int) -> float:
    """What an input socket receives where only a constant will do."""
    value = read(use, key)
    if value.lookup is not None:
        use.note(f"needs a constant as its '{use.node.inputs[key].name}'; the mean of the texture is used instead")
    return float(value.mean().factor[0])


def calculator(use: NodeUse) -> Calculator:
    return Calculator(use.material, use.context)


def grey(x: np.ndarray) -> np.ndarray:
    return np.repeat((x @ LUMINANCE.astype(x.dtype))[..., None], 3, axis=-1)


def _clamp(x: np.ndarray) -> np.ndarray:
    return np.clip(x, 0.0, 1.0)


def _image_texture(use: NodeUse, output: Any) -> Value | None:
    node = use.node
    image = node.image
    if image is None:
        use.note("has no image; magenta is shown instead")
        return constant(MISSING)
    if reason := missing(image):
        use.note(f"needs an image; {reason}; magenta is shown instead")
        return constant(MISSING)
    for deviation in deviations(image):
        use.note(f"shows {deviation}")
    if node.projection != "FLAT":
        use.note(f"has the projection {node.projection.title()}, which is not supported; the image is mapped by UVs")
    lookup = Lookup(image, node.interpolation, node.extension, _transform(use))
    if output.name == "Alpha":
        return Value(np.ones(3), lookup, lambda texel: np.repeat(texel[..., 3:], 3, axis=-1), "alpha")
    return Value(np.ones(3), lookup)


def _transform(use: NodeUse) -> tuple[float, float, float, float, float, float]:
    """The affine map from the mesh's UVs to those of an image."""
    matrix = Matrix.Identity(4)
    output, origin = use.origin("Vector")
    while origin is not None and origin.node.bl_idname == "ShaderNodeMapping":
        matrix = matrix @ _mapping(origin)
        output, origin = origin.origin("Vector")
    if origin is not None and origin.node.bl_idname == "ShaderNodeUVMap":
        if origin.node.uv_map:
            origin.note(f"names the UV map '{origin.node.uv_map}'; the one that is active for rendering is used")
    elif origin is not None and (origin.node.bl_idname, output.name) != ("ShaderNodeTexCoord", "UV"):
        origin.note(f"gives coordinates ({output.name}) that are not supported; UVs are used instead")
    (a, b, _, c), (d, e, _, f) = matrix[0], matrix[1]
    return (a, b, c, d, e, f)


def _mapping(use: NodeUse) -> Matrix:
    kind = use.node.vector_type
    location, rotation, scale = (
        read(use, name).mean().factor if use.node.inputs[name].enabled else (0.0, 0.0, 0.0)
        for name in ("Location", "Rotation", "Scale")
    )
    matrix = Matrix.LocRotScale(location, Euler(rotation), scale)
    return matrix.inverted_safe() if kind == "TEXTURE" else matrix


MATH: dict[str, Function] = {
    "ADD": np.add,
    "SUBTRACT": np.subtract,
    "MULTIPLY": np.multiply,
    "DIVIDE": lambda a, b: np.divide(a, b, out=np.zeros(np.broadcast(a, b).shape), where=b != 0),
    "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "POWER": lambda a, b: np.power(np.maximum(a, 0.0), b),
    "SQRT": lambda a: np.sqrt(np.maximum(a, 0.0)),
    "ABSOLUTE": np.abs,
    "MINIMUM": np.minimum,
    "MAXIMUM": np.maximum,
    "LESS_THAN": lambda a, b: (a < b) * 1.0,
    "GREATER_THAN": lambda a, b: (a > b) * 1.0,
}


def _math(use: NodeUse, _output: Any) -> Value | None:
    function = MATH.get(use.node.operation)
    if function is None:
        return None
    operands = [read(use, i) for i, socket in enumerate(use.node.inputs) if socket.enabled]
    value = calculator(use).apply(use.node.operation, function, *operands)
    return calculator(use).apply("clamp", _clamp, value) if use.node.use_clamp else value


BLENDS: dict[str, Function] = {
    "MIX": lambda a, b: b,
    "ADD": np.add,
    "SUBTRACT": np.subtract,
    "MULTIPLY": np.multiply,
    "SCREEN": lambda a, b: 1.0 - (1.0 - a) * (1.0 - b),
    "DIFFERENCE": lambda a, b: np.abs(a - b),
    "DARKEN": np.minimum,
    "LIGHTEN": np.maximum,
}


def _blend(use: NodeUse, factor: Value, a: Value, b: Value, blend: str, clamp_result: bool) -> Value | None:
    function = BLENDS.get(blend)
    if function is None:
        return None
    calc = calculator(use)
    blended = calc.apply(blend, lambda t, x, y: x + t * (function(x, y) - x), factor, a, b)
    return calc.apply("clamp", _clamp, blended) if clamp_result else blended


def _mix_rgb(use: NodeUse, _output: Any) -> Value | None:
    factor = calculator(use).apply("clamp", _clamp, read(use, 0))
    return _blend(use, factor, read(use, 1), read(use, 2), use.node.blend_type, use.node.use_clamp)


def _mix(use: NodeUse, _output: Any) -> Value | None:
    node = use.node
    if node.data_type not in {"FLOAT", "RGBA"}:
        return None
    # of each name the node has one socket per data type, all but one disabled
    factor, a, b = (read(use, i) for i, socket in enumerate(node.inputs) if socket.enabled)
    if node.clamp_factor:
        factor = calculator(use).apply("clamp", _clamp, factor)
    if node.data_type == "FLOAT":
        return _blend(use, factor, a, b, "MIX", False)
    return _blend(use, factor, a, b, node.blend_type, node.clamp_result)


def _gamma(use: NodeUse, _output: Any) -> Value:
    return calculator(use).apply("gamma", MATH["POWER"], read(use, "Color"), read(use, "Gamma"))


def _invert(use: NodeUse, _output: Any) -> Value:
    return calculator(use).apply("invert", lambda t, c: c + t * (1.0 - 2.0 * c), read(use, 0), read(use, "Color"))


def _bright_contrast(use: NodeUse, _output: Any) -> Value:
    def function(c, bright, contrast):
        return np.maximum((1.0 + contrast) * c + bright - contrast * 0.5, 0.0)

    return calculator(use).apply("bright", function, read(use, "Color"), read(use, "Bright"), read(use, "Contrast"))


def _ramp(use: NodeUse, output: Any) -> Value:
    """Blender evaluates a ramp one colour at a time, so texels look it up in a table."""
    steps = np.linspace(0.0, 1.0, 1025)
    table = np.array([use.node.color_ramp.evaluate(step) for step in steps])
    if output.name == "Alpha":
        table[:, :3] = table[:, 3:]

    def function(x):
        return np.stack([np.interp(x[..., 0], steps, table[:, channel]) for channel in range(3)], axis=-1)

    return calculator(use).apply(f"ramp {table[::64].tolist()}", function, read(use, 0))


def _separate(use: NodeUse, output: Any) -> Value | None:
    if getattr(use.node, "mode", "RGB") != "RGB":
        return None
    channel = list(use.node.outputs).index(output)
    return calculator(use).apply(
        f"channel {channel}", lambda c: np.repeat(c[..., channel, None], 3, axis=-1), read(use, 0)
    )


def _combine(use: NodeUse, _output: Any) -> Value | None:
    if getattr(use.node, "mode", "RGB") != "RGB":
        return None

    def function(r, g, b):
        return np.stack(np.broadcast_arrays(r[..., 0], g[..., 0], b[..., 0]), axis=-1)

    return calculator(use).apply("combine", function, read(use, 0), read(use, 1), read(use, 2))


def _own_value(use: NodeUse, socket: Any) -> Value:
    """What is typed into a socket: of an input, or of a node that is nothing but a value."""
    value = constant(socket.default_value)
    if not np.isfinite(value.factor).all():
        use.note(f"has a '{socket.name}' that is not a finite number; the material is rendered as magenta")
        raise NotFinite
    return value


CONVERTERS: dict[str, Callable[[NodeUse, Any], Value | None]] = {
    "ShaderNodeRGB": _own_value,
    "ShaderNodeValue": _own_value,
    "ShaderNodeTexImage": _image_texture,
    "ShaderNodeMath": _math,
    "ShaderNodeMix": _mix,
    "ShaderNodeMixRGB": _mix_rgb,
    "ShaderNodeGamma": _gamma,
    "ShaderNodeInvert": _invert,
    "ShaderNodeBrightContrast": _bright_contrast,
    "ShaderNodeValToRGB": _ramp,
    "ShaderNodeRGBToBW": lambda use, _output: calculator(use).grey(read(use, 0)),
    "ShaderNodeSeparateColor": _separate,
    "ShaderNodeSeparateRGB": _separate,
    "ShaderNodeCombineColor": _combine,
    "ShaderNodeCombineRGB": _combine,
}
