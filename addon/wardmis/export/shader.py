# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's shaders -> what Ward's model needs: the sum of a diffuse part, one lobe, and light."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .. import compat
from . import converters  # noqa: F401  fills what read() knows
from .image import MISSING
from .read import read, read_number
from .tree import NodeUse
from .value import BLACK, Value, calculator, constant, grey


@dataclass(frozen=True)
class Surface:
    """What a shader node stands for."""

    diffuse: Value = BLACK
    specular: Value = BLACK
    alpha_x: Value = BLACK
    alpha_y: Value = BLACK
    rotation: float = 0.0  # radians
    variant: str = "ward-gmd"
    emission: Value = BLACK


FALLBACK = Surface(diffuse=constant(MISSING))


def shader(use: NodeUse, key: str | int) -> Surface:
    """What an input for a shader receives; nothing connected is black, as in Cycles."""
    source = use.source(key)
    if source.is_nothing:
        return Surface()
    if source.socket.type != "SHADER":  # a colour in a shader's place shines, as in Cycles
        return Surface(emission=read(use, key))
    origin = source.use
    assert origin is not None
    kind = origin.node.bl_idname
    converter = (SHADERS if origin.owner.kind == "material" else LIGHT_SHADERS).get(kind)
    if kind == "ShaderNodeBackground" and origin.owner.kind == "light" and not compat.BACKGROUND_LIGHTS_LAMPS:
        origin.note("gives no light in a lamp, in Cycles of this Blender either; use Emission")
        return Surface()
    if converter is None and origin.owner.kind == "material":
        origin.note("is not supported; rendered as magenta")
        return FALLBACK
    if converter is None:  # what scatters light gives none, in Cycles too
        origin.note(f"is not supported in a {origin.owner.kind}; it gives no light")
        return Surface()
    if origin.owner.kind == "material" and origin.is_linked("Normal"):
        origin.note("has a normal from other nodes, which is not supported; the surface's own normal is used")
    return converter(origin)


# ---- sums ----------------------------------------------------------------------------------------------------------


def _add(use: NodeUse, a: Surface, b: Surface) -> Surface:
    calc = calculator(use)
    return replace(
        _add_specular(use, a, b),
        diffuse=calc.add(a.diffuse, b.diffuse),
        emission=calc.add(a.emission, b.emission),
    )


def _add_specular(use: NodeUse, a: Surface, b: Surface) -> Surface:
    """The specular part of the sum. Two lobes of different shape become one between them."""
    if a.specular.is_black or b.specular.is_black:
        return b if a.specular.is_black else a
    calc = calculator(use)
    weights = [float(grey(s.specular.mean().factor)[0]) for s in (a, b)]
    stronger = a if weights[0] >= weights[1] else b
    specular = calc.add(a.specular, b.specular)
    if _shape(a) == _shape(b):
        return replace(stronger, specular=specular)
    use.note("combines two glossy lobes; one lobe of their mean roughness is rendered")
    share = weights[1] / sum(weights)

    def mean(x: Value, y: Value) -> Value:
        return calc.add(calc.multiply(x, constant(1.0 - share)), calc.multiply(y, constant(share)))

    return replace(stronger, specular=specular, alpha_x=mean(a.alpha_x, b.alpha_x), alpha_y=mean(a.alpha_y, b.alpha_y))


def _shape(s: Surface) -> tuple[Any, ...]:
    return (str(s.alpha_x), str(s.alpha_y), s.rotation, s.variant)


def _scaled(use: NodeUse, surface: Surface, weight: Value) -> Surface:
    calc = calculator(use)
    diffuse, specular, emission = (
        calc.multiply(part, weight) for part in (surface.diffuse, surface.specular, surface.emission)
    )
    return replace(surface, diffuse=diffuse, specular=specular, emission=emission)


def _add_shader(use: NodeUse) -> Surface:
    return _add(use, shader(use, 0), shader(use, 1))


def _mix_shader(use: NodeUse) -> Surface:
    calc = calculator(use)
    share = calc.clamp(read(use, 0))
    a, b = _scaled(use, shader(use, 1), calc.complement(share)), _scaled(use, shader(use, 2), share)
    return _add(use, a, b)


# ---- shaders -------------------------------------------------------------------------------------------------------


def _ward(use: NodeUse) -> Surface:
    return Surface(
        read(use, "Diffuse Color"),
        read(use, "Specular Color"),
        read(use, "Alpha X"),
        read(use, "Alpha Y"),
        _angle(use, "Rotation"),
        use.node.variant,
    )


def _diffuse(use: NodeUse) -> Surface:
    if not read(use, "Roughness").is_black:
        use.note("is rough (Oren-Nayar), which is not supported; it is rendered as Lambertian")
    return Surface(diffuse=read(use, "Color"))


def _glossy(use: NodeUse) -> Surface:
    alpha = BLACK if use.node.distribution == "SHARP" else _alpha(use)
    anisotropy = read_number(use, "Anisotropy") if use.has("Anisotropy") else 0.0
    # as Cycles shares the roughness between the axes
    along = 1.0 - min(abs(anisotropy), 0.99)
    x, y = (along, 1.0 / along) if anisotropy >= 0.0 else (1.0 / along, along)
    rotation = _angle(use, "Rotation") if use.has("Rotation") else 0.0
    return _stretched(use, Surface(specular=read(use, "Color"), rotation=rotation), alpha, x, y)


def _principled(use: NodeUse) -> Surface:
    calc = calculator(use)
    for name in compat.PRINCIPLED_EXTRAS:
        if use.has(name) and not read(use, name).is_black:
            use.note(f"has '{name}', which is not supported; it is left out")
    if not calc.complement(read(use, "Alpha")).is_black:
        use.note("has an alpha below 1, which is not supported; it is rendered opaque")

    base, metallic = read(use, "Base Color"), read(use, "Metallic")
    dielectric = calc.complement(metallic)
    metal = calc.multiply(base, metallic)
    reflectance = _normal_reflectance(use)
    gloss = calc.multiply(calc.multiply(reflectance, _tint(use, base)), dielectric)
    below = calc.complement(reflectance.mean()) if compat.PRINCIPLED_LAYERS else constant(1.0)
    anisotropy = read_number(use, "Anisotropic")
    aspect = math.sqrt(1.0 - 0.9 * min(max(anisotropy, 0.0), 1.0))  # as Cycles shares the roughness between the axes
    surface = Surface(
        diffuse=calc.multiply(calc.multiply(base, dielectric), below),
        specular=calc.add(metal, gloss),
        rotation=_angle(use, "Anisotropic Rotation"),
        emission=calc.multiply(read(use, compat.PRINCIPLED_EMISSION), read(use, "Emission Strength")),
    )
    return _stretched(use, surface, _alpha(use), 1.0 / aspect, aspect)


def _normal_reflectance(use: NodeUse) -> Value:
    """Of the dielectric layer, seen straight on: 0.04 by default."""
    level = read(use, compat.PRINCIPLED_SPECULAR)
    if not compat.PRINCIPLED_SPECULAR_OF_IOR:
        return calculator(use).multiply(level, constant(0.08))
    ior = read_number(use, "IOR")
    return calculator(use).multiply(level, constant(2.0 * ((ior - 1.0) / (ior + 1.0)) ** 2))


def _tint(use: NodeUse, base: Value) -> Value:
    """The colour of the dielectric's reflection: up to 3.x the base's hue by a share, since then a colour of its own."""
    tint = read(use, "Specular Tint")
    if use.node.inputs["Specular Tint"].type == "RGBA":
        return tint
    if tint.is_black:
        return constant(1.0)

    def hue(share, color):
        luminance = grey(color)
        return 1.0 + share * (np.divide(color, luminance, out=np.ones_like(color), where=luminance > 0) - 1.0)

    return calculator(use).apply("tint", hue, tint, base)


def _emission(use: NodeUse) -> Surface:
    return Surface(emission=calculator(use).multiply(read(use, "Color"), read(use, "Strength")))


def _alpha(use: NodeUse) -> Value:
    """Ward's alpha is Blender's roughness squared: both end as exp(-tan^2 / alpha^2) for Beckmann."""
    return calculator(use).apply("square", np.square, read(use, "Roughness"))


def _angle(use: NodeUse, key: str) -> float:
    return 2.0 * math.pi * read_number(use, key)


def _stretched(use: NodeUse, surface: Surface, alpha: Value, x: float, y: float) -> Surface:
    calc = calculator(use)
    return replace(surface, alpha_x=calc.multiply(alpha, constant(x)), alpha_y=calc.multiply(alpha, constant(y)))


SHADERS: dict[str, Callable[[NodeUse], Surface]] = {
    "WardBSDFNode": _ward,
    "ShaderNodeBsdfDiffuse": _diffuse,
    "ShaderNodeBsdfGlossy": _glossy,
    "ShaderNodeBsdfAnisotropic": _glossy,
    "ShaderNodeBsdfPrincipled": _principled,
    "ShaderNodeEmission": _emission,
    "ShaderNodeAddShader": _add_shader,
    "ShaderNodeMixShader": _mix_shader,
}
LIGHT_SHADERS = {**SHADERS, "ShaderNodeBackground": _emission}  # of worlds and lights
