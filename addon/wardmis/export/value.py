# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours and numbers of a node tree: a constant, or a texture after functions that see one texel at a time.

The same numpy functions work on a constant and on all texels of an image, so a texture behind a Gamma or a Math node is
baked once instead of being left out. Everything is RGB: a number is a grey colour, a vector a colour of its coordinates.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from .image import BakedImage, Picture, encode_srgb
from .model import ColorInput, ScalarInput, TextureUse
from .resample import fine_size, finer
from .tree import NodeUse, Owner

LUMINANCE = np.array((0.2126, 0.7152, 0.0722))  # of linear Rec. 709

Function = Callable[..., Any]  # of arrays (..., 3) to one


class NotFinite(Exception):
    """A number in the tree is NaN or infinite, and has been named in a note."""


@dataclass(frozen=True)
class Lookup:
    """Which texel: two values with equal look-ups see the same one.

    `transform`: of six numbers, the affine map from the mesh's UVs to the picture's; of nine, the matrix from a direction of the
    world to the one that is looked up in an equirectangular picture.
    """

    picture: Picture
    interpolation: str
    extension: str
    transform: tuple[float, ...]

    @property
    def is_sky(self) -> bool:
        return len(self.transform) == 9


@dataclass(frozen=True)
class Value:
    """`factor`, with a look-up times its RGB or what `function` makes of its RGBA, called `recipe` to tell functions apart."""

    factor: np.ndarray
    lookup: Lookup | None = None
    function: Function | None = None
    recipe: str = "texel"

    def of(self, texel: np.ndarray) -> np.ndarray:
        if self.lookup is None:
            return self.factor
        return self.factor.astype(np.float32) * (self.function(texel) if self.function else texel[..., :3])

    def mean(self) -> Value:
        """Over the picture; of a sky over all directions."""
        if self.lookup is None:
            return self
        rows = self.of(self.lookup.picture.texels()).mean(axis=1, dtype=float)
        angles = np.linspace(0.0, np.pi, len(rows) + 1)
        solid_angles = np.cos(angles[:-1]) - np.cos(angles[1:]) if self.lookup.is_sky else None
        return Value(np.average(rows, axis=0, weights=solid_angles))

    @property
    def is_black(self) -> bool:
        return not self.factor.any()

    def __str__(self) -> str:
        """What it is made of, exactly: a baked image is known by it."""
        return f"{self.factor.tolist()}" + (f" {self.recipe}" if self.lookup else "")


def constant(value: Any) -> Value:
    """Of a number, an RGB or an RGBA."""
    return Value(np.broadcast_to(np.atleast_1d(np.array(value, float))[:3], 3))


BLACK = constant(0.0)


@dataclass(frozen=True)
class Calculator:
    """Arithmetic with values, and whom to tell what it cannot do."""

    owner: Owner

    def apply(self, name: str, function: Function, *values: Value) -> Value:
        """function(*values) per texel; `name` must tell it from all others.

        Only one texture can be looked up at a time: others count with their mean.
        """
        lookups = {value.lookup for value in values if value.lookup is not None}
        if not lookups:
            return Value(np.asarray(function(*(value.factor for value in values)), float))
        if len(lookups) > 1:
            kept = next(value.lookup for value in values if value.lookup is not None)
            self.owner.context.note(
                f"{self.owner.place}: several textures are combined; only '{kept.picture.image.name}' is kept, "
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

    def clamp(self, a: Value) -> Value:
        return self.apply("clamp", lambda x: np.clip(x, 0.0, 1.0), a)

    def color_input(self, a: Value) -> ColorInput:
        r, g, b = (float(x) for x in np.maximum(a.factor, 0.0))  # a NaN stays one
        return ColorInput((r, g, b), self.texture(a, 3) if a.lookup and not a.is_black else None)

    def scalar_input(self, a: Value) -> ScalarInput:
        a = self.grey(a)
        return ScalarInput(float(np.maximum(a.factor[0], 0.0)), self.texture(a, 1) if a.lookup else None)

    def texture(self, a: Value, channels: int) -> TextureUse:
        assert a.lookup is not None
        picture: Any = a.lookup.picture
        interpolation, extension, function = a.lookup.interpolation, a.lookup.extension, a.function
        if function is not None:
            # a large one, encoded as its source, is filtered nearly as in Cycles, whose nodes see filtered colours; alpha is not
            source, encoded, how = picture, picture.is_encoded and "texel" in a.recipe, (interpolation, extension)
            width, height = source.image.size
            if source.frame is not None:
                self.owner.context.note(
                    f"{self.owner.place}: image '{source.name}' is a sequence; behind nodes the picture that Blender holds now is used"
                )
            size = (width, height) if interpolation == "Closest" else fine_size(width, height)

            def filtered(pixels: np.ndarray) -> np.ndarray:
                return pixels if size == (width, height) else finer(pixels, size[0], size[1], *how)

            def bake() -> np.ndarray:
                baked = function(source.texels(filtered))[..., :channels]
                return (encode_srgb(baked) if encoded else baked).astype(np.float32)

            name = f"{picture.image.name} (baked)"
            picture = BakedImage(name, f"{picture.name_full} {how}: {a.recipe}, {channels}", bake, encoded)
            interpolation = interpolation if size == (width, height) else "Linear"
        index = self.owner.context.texture(picture, interpolation, extension)
        return TextureUse(index) if a.lookup.is_sky else TextureUse(index, transform=a.lookup.transform)  # type: ignore[arg-type]


def calculator(use: NodeUse) -> Calculator:
    return Calculator(use.owner)


def grey(x: np.ndarray) -> np.ndarray:
    return np.repeat((x @ LUMINANCE.astype(x.dtype))[..., None], 3, axis=-1)


def converted(calc: Calculator, value: Value, kinds: tuple[str, ...]) -> Value:
    """Blender's implicit conversions of a value of the first kind of socket to the others in turn."""
    for before, after in pairwise(kinds):
        number = after in {"VALUE", "INT", "BOOLEAN"}
        if number and before == "RGBA":
            value = calc.grey(value)
        elif number and before in {"VECTOR", "ROTATION"}:
            value = calc.apply("coordinates' mean", lambda x: np.repeat(x.mean(-1, keepdims=True), 3, -1), value)
        if after == "INT" and before != "INT":
            value = calc.apply("truncated", np.trunc, value)
    return value
