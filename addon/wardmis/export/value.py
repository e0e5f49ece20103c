# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours and numbers of a node tree: a constant, or a texture after functions that see one texel at a time.

The same numpy functions work on a constant and on all texels of an image, so a texture behind a Gamma or a Math node is
baked once instead of being left out. Everything is RGB: a number is a grey colour, a vector a colour of its coordinates.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from .image import BakedImage, encode_srgb
from .lookup import Lookup, common_size, shown_exactly
from .model import ColorInput, ScalarInput, TextureUse
from .tree import NodeUse, Owner

LUMINANCE = np.array((0.2126, 0.7152, 0.0722))  # of linear Rec. 709

Function = Callable[..., Any]  # of arrays (..., 3) to one
Texels = dict[Lookup, np.ndarray]  # what each sees, (..., 4)


class NotFinite(Exception):
    """A number in the tree is NaN or infinite, and has been named in a note."""


@dataclass(frozen=True)
class Value:
    """`factor`, times what `function` makes of the RGBA that the look-ups see; `recipe` tells functions apart.

    All look-ups have the same coordinates. What the function is given, and what it returns, are arrays (..., 4) by look-up, and
    an array (..., 3). Without a function it is the colour that the only look-up sees.
    """

    factor: np.ndarray
    lookups: tuple[Lookup, ...] = ()
    function: Function | None = None
    recipe: str = ""

    @property
    def lookup(self) -> Lookup | None:
        """Where it is looked up."""
        return self.lookups[0] if self.lookups else None

    def of(self, texels: Texels) -> np.ndarray:
        if not self.lookups:
            return self.factor
        return self.factor.astype(np.float32) * (
            self.function(texels) if self.function else texels[self.lookups[0]][..., :3]
        )

    def seen(self) -> np.ndarray:
        """(height, width, 3): what it is over the whole picture."""
        width, height = common_size(self.lookups)
        return self.of({lookup: lookup.seen(width, height) for lookup in self.lookups})

    def mean(self) -> Value:
        """Over the picture; of a sky over all directions."""
        if self.lookup is None:
            return self
        seen = self.seen()
        solid_angles = solid_angles_of(self.lookup.projection, *seen.shape[:2]) if self.lookup.is_sky else None
        return Value(np.average(seen.reshape(-1, 3).astype(float), axis=0, weights=solid_angles))

    @property
    def is_black(self) -> bool:
        return not self.factor.any()

    def __str__(self) -> str:
        """What it is made of, exactly: a baked image is known by it."""
        if not self.lookups:
            return f"{self.factor.tolist()}"
        return f"{self.factor.tolist()} {self.recipe or f'color of {self.lookups[0]}'}"


def constant(value: Any) -> Value:
    """Of a number, an RGB or an RGBA."""
    return Value(np.broadcast_to(np.atleast_1d(np.array(value, float))[:3], 3))


BLACK = constant(0.0)


def solid_angles_of(projection: str, height: int, width: int) -> np.ndarray:
    """Of the pixels of a picture of all directions, row by row, in any unit."""
    if projection == "mirror-ball":  # the same for all that lie in the disk
        y, x = np.mgrid[0:height, 0:width] + 0.5
        return np.float64(np.hypot(2.0 * x / width - 1.0, 2.0 * y / height - 1.0) <= 1.0).reshape(-1)
    parallels = np.cos(np.linspace(0.0, np.pi, height + 1))
    return np.repeat(parallels[:-1] - parallels[1:], width)


@dataclass(frozen=True)
class Calculator:
    """Arithmetic with values, and whom to tell what it cannot do."""

    owner: Owner

    def apply(self, name: str, function: Function, *values: Value) -> Value:
        """function(*values) per texel; `name` must tell it from all others.

        Only textures with the same coordinates can be combined: others than the first one's count with their mean.
        """
        lookups = tuple(dict.fromkeys(lookup for value in values for lookup in value.lookups))
        if not lookups:
            return Value(np.asarray(function(*(value.factor for value in values)), float))
        if not all(lookup.goes_with(lookups[0]) for lookup in lookups):
            self.owner.context.note(
                f"{self.owner.place}: textures with different coordinates are combined; only '{lookups[0].picture.name}' and those "
                "with the same are kept, the others are replaced by their mean"
            )
            values = tuple(v if v.lookup is None or v.lookup.goes_with(lookups[0]) else v.mean() for v in values)
            lookups = tuple(lookup for lookup in lookups if lookup.goes_with(lookups[0]))
        recipe = f"{name}({', '.join(map(str, values))})"
        return Value(np.ones(3), lookups, lambda t: function(*(value.of(t) for value in values)), recipe)

    def add(self, a: Value, b: Value) -> Value:
        if a.is_black or b.is_black:
            return b if a.is_black else a
        return self.apply("add", np.add, a, b)

    def multiply(self, a: Value, b: Value) -> Value:
        """A constant factor needs no new image."""
        if a.lookup is None or b.lookup is None:
            textured = b if a.lookup is None else a
            return Value(a.factor * b.factor, textured.lookups, textured.function, textured.recipe)
        return self.apply("multiply", np.multiply, a, b)

    def complement(self, a: Value) -> Value:
        return self.apply("complement", lambda x: 1.0 - x, a)

    def grey(self, a: Value) -> Value:
        return self.apply("grey", grey, a)

    def clamp(self, a: Value) -> Value:
        return self.apply("clamp", lambda x: np.clip(x, 0.0, 1.0), a)

    def color_input(self, a: Value, least: float = 0.0) -> ColorInput:
        """`least`: what is below is cut. A surface that reflects less than nothing reflects nothing."""
        r, g, b = (float(x) for x in np.maximum(a.factor, least))  # a NaN stays one
        return ColorInput((r, g, b), self.texture(a, 3) if a.lookup and not a.is_black else None)

    def light_input(self, a: Value) -> ColorInput:
        """Of light there may be less than none: it takes other light away, as in Cycles."""
        return self.color_input(a, -math.inf)

    def scalar_input(self, a: Value) -> ScalarInput:
        a = self.grey(a)
        return ScalarInput(float(np.maximum(a.factor[0], 0.0)), self.texture(a, 1) if a.lookup else None)

    def texture(self, a: Value, channels: int) -> TextureUse:
        """One that shows the value without its factor: the picture itself where nothing is made of it, else a new image."""
        lookup = a.lookup
        assert lookup is not None
        image: Any = lookup.picture
        interpolation = lookup.interpolation
        if a.function is not None or lookup.warp:
            image = self._baked(Value(np.ones(3), a.lookups, a.function, a.recipe), channels)
            interpolation = "Closest" if shown_exactly(a.lookups) else "Linear"
        index = self.owner.context.texture(image, interpolation, lookup.extension)
        return TextureUse(index) if lookup.is_sky else TextureUse(index, transform=lookup.transform)  # type: ignore[arg-type]

    def _baked(self, a: Value, channels: int) -> BakedImage:
        pictures = [lookup.picture for lookup in a.lookups]
        for picture in pictures:
            if picture.frame is not None:
                self.owner.context.note(
                    f"{self.owner.place}: image '{picture.name}' is a sequence; behind nodes the picture that Blender holds now is used"
                )
        # encoded as its source, a large image is filtered nearly as in Cycles, whose nodes see filtered colours; alpha is no colour
        encoded = all(picture.is_encoded for picture in pictures) and "color of" in str(a)

        def bake() -> np.ndarray:
            baked = a.seen()[..., :channels]
            return (encode_srgb(baked) if encoded else baked).astype(np.float32)

        return BakedImage(f"{pictures[0].name} (baked)", f"{a}, {channels} channels", bake, encoded)


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
