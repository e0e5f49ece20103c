# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's shaders -> the closures of a surface, each with what the shaders above it leave of it, and its light."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from ... import compat
from ..tree import NodeUse
from .builder import Value, is_constant, is_zero
from .reader import Reader

WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
MOST_SHADERS = 4096  # each time that one is met on the way from the output; zones can double them again and again


@dataclass
class Closure:
    """One of docs/scene-format.md, "Closures". `weight`: a number; `normal`, `tangent` None: the surface's own."""

    use: NodeUse
    type: str
    weight: Value
    inputs: dict[str, Value]
    parameters: dict[str, Any] = field(default_factory=dict)
    normal: Value | None = None
    tangent: Value | None = None


class Shading:
    """What a shader tree stands for."""

    def __init__(self, p: Reader) -> None:
        self.p = p
        self.closures: list[Closure] = []
        self.emission: Value = BLACK
        self._left = MOST_SHADERS
        self._open: set[Any] = set()  # what is being read

    def read(self, use: NodeUse, key: str | int, weight: Value = 1.0) -> None:
        """What an input for a shader receives; nothing connected is black, as in Cycles."""
        if is_zero(weight):
            return
        source = use.source(key)
        if source.is_nothing:
            return
        if source.socket.type != "SHADER":  # a colour in a shader's place shines, as in Cycles
            self.emit(self.p.vector(self.p.read(use, key)), weight)
            return
        origin = source.use
        assert origin is not None
        if self._left == 0:
            use.owner.context.note(
                f"{use.owner.place}: its nodes make more shaders than can be rendered; the first {MOST_SHADERS} are"
            )
            return
        self._left -= 1
        kind = origin.node.bl_idname
        if kind not in SHADERS:
            self.add_unknown(origin, weight)
            return
        if origin.place in self._open:
            raise RecursionError
        self._open.add(origin.place)
        SHADERS[kind](origin, self, weight)
        self._open.remove(origin.place)

    def add_unknown(self, use: NodeUse, weight: Value) -> None:
        use.note("is not supported as a surface; rendered as grey and diffuse")
        self.add(use, "diffuse", weight, color=(0.8, 0.8, 0.8))

    def emit(self, radiance: Value, weight: Value) -> None:
        self.emission = self.p.add(self.emission, self.p.multiply(radiance, weight))

    def add(
        self,
        use: NodeUse,
        type: str,
        weight: Value,
        parameters: Any = None,
        tangent: Value | None = None,
        **inputs: Value,
    ) -> None:
        if is_zero(inputs.get("color", WHITE)):
            return
        normal = self.p.linked(use, "Normal")
        self.closures.append(Closure(use, type, weight, inputs, parameters or {}, normal, tangent))


def _add_shader(use: NodeUse, s: Shading, weight: Value) -> None:
    s.read(use, 0, weight)
    s.read(use, 1, weight)


def _mix_shader(use: NodeUse, s: Shading, weight: Value) -> None:
    p = s.p
    share = p("clamp", p.read(use, 0), 0.0, 1.0)
    s.read(use, 1, p.multiply(weight, p.complement(share)))
    s.read(use, 2, p.multiply(weight, share))


def _ward(use: NodeUse, s: Shading, weight: Value) -> None:
    p = s.p
    s.add(use, "diffuse", weight, color=p.read(use, "Diffuse Color"))
    shape = {"alphaX": p.read(use, "Alpha X"), "alphaY": p.read(use, "Alpha Y"), **_turn(use, p)}
    s.add(use, "ward", weight, {"variant": use.node.variant}, color=p.read(use, "Specular Color"), **shape)


def _turn(use: NodeUse, p: Reader, name: str = "Rotation") -> dict[str, Value]:
    return {"rotation": p.multiply(p.read(use, name), 2.0 * math.pi)} if use.has(name) else {}


def _tangent(use: NodeUse, p: Reader) -> Value:
    """From which Cycles turns the axes of the anisotropy."""
    linked = p.linked(use, "Tangent")
    return p("tangent", axis="z") if linked is None else linked


def _square(p: Reader, value: Value) -> Value:
    return p("multiply", value, value)


def _diffuse(use: NodeUse, s: Shading, weight: Value) -> None:
    roughness = s.p.read(use, "Roughness")
    rough = {} if is_zero(roughness) else {"roughness": roughness}
    s.add(use, "diffuse", weight, color=s.p.read(use, "Color"), **rough)


def _translucent(use: NodeUse, s: Shading, weight: Value) -> None:
    s.add(use, "translucent", weight, color=s.p.read(use, "Color"))


def _transparent(use: NodeUse, s: Shading, weight: Value) -> None:
    s.add(use, "transparent", weight, color=s.p.read(use, "Color"))


DISTRIBUTIONS = {
    "SHARP": "ggx",  # up to 4.0; of roughness 0
    "GGX": "ggx",
    "BECKMANN": "beckmann",
    "MULTI_GGX": "multi-ggx",
    "ASHIKHMIN_SHIRLEY": "ashikhmin-shirley",
}


def _distribution(use: NodeUse) -> dict[str, Any]:
    return {"distribution": DISTRIBUTIONS[use.node.distribution], "version": compat.CYCLES}


def _alpha(use: NodeUse, p: Reader) -> Value:
    """Blender's roughness squared."""
    return 0.0 if use.node.distribution == "SHARP" else _square(p, p.read(use, "Roughness"))


def _glossy(use: NodeUse, s: Shading, weight: Value) -> None:
    p = s.p
    x = y = _alpha(use, p)
    anisotropy = p.read(use, "Anisotropy") if use.has("Anisotropy") else 0.0
    turn: dict[str, Value] = {}
    tangent = None
    if not is_zero(anisotropy):  # as Cycles shares the roughness between the axes
        most = p("minimum", p("absolute", anisotropy), 0.99)
        along = p.complement(most)
        short, long = p("multiply", x, along), p("divide", x, along)
        first = p("greater-than", 0.0, anisotropy)
        x, y = p("mix-number", first, short, long), p("mix-number", first, long, short)
        turn, tangent = _turn(use, p), _tangent(use, p)
    s.add(use, "glossy", weight, _distribution(use), tangent, color=p.read(use, "Color"), alphaX=x, alphaY=y, **turn)


def _refractive(kind: str) -> Callable[[NodeUse, Shading, Value], None]:
    def read(use: NodeUse, s: Shading, weight: Value) -> None:
        p = s.p
        _note_thin_film(use, p)
        s.add(
            use,
            kind,
            weight,
            _distribution(use),
            color=p.read(use, "Color"),
            alpha=_alpha(use, p),
            ior=p.read(use, "IOR"),
        )

    return read


def _sheen(use: NodeUse, s: Shading, weight: Value) -> None:
    """Velvet until 4.0, then a choice of two."""
    p, node = s.p, use.node
    if node.bl_idname == "ShaderNodeBsdfVelvet" or getattr(node, "distribution", "") == "ASHIKHMIN":
        sigma = p.read(use, "Sigma" if use.has("Sigma") else "Roughness")
        s.add(use, "velvet", weight, color=p.read(use, "Color"), sigma=sigma)
    else:
        s.add(use, "sheen", weight, color=p.read(use, "Color"), roughness=p.read(use, "Roughness"))


def _holdout(use: NodeUse, s: Shading, weight: Value) -> None:
    s.closures.append(Closure(use, "holdout", weight, {}))


def _subsurface(use: NodeUse, s: Shading, weight: Value) -> None:
    use.note("is not supported; rendered as diffuse")
    s.add(use, "diffuse", weight, color=s.p.read(use, "Color"))


def _toon(use: NodeUse, s: Shading, weight: Value) -> None:
    glossy = use.node.component == "GLOSSY"
    use.note(f"is not supported; rendered as {'glossy' if glossy else 'diffuse'}")
    color = s.p.read(use, "Color")
    if glossy:
        alpha = _square(s.p, s.p.read(use, "Size"))
        s.add(
            use,
            "glossy",
            weight,
            {"distribution": "ggx", "version": compat.CYCLES},
            color=color,
            alphaX=alpha,
            alphaY=alpha,
        )
    else:
        s.add(use, "diffuse", weight, color=color)


def _as_diffuse(use: NodeUse, s: Shading, weight: Value) -> None:
    use.note("is not supported; rendered as diffuse")
    color = s.p.read(use, "Color") if use.has("Color") else (0.8, 0.8, 0.8)
    s.add(use, "diffuse", weight, color=color)


def _metallic(use: NodeUse, s: Shading, weight: Value) -> None:
    """The metal of the Principled shader."""
    p = s.p
    if use.node.fresnel_type == "F82":
        color, edge = p.read(use, "Base Color"), p.read(use, "Edge Tint")
    else:
        use.note("has a physical Fresnel; what it reflects at 0 and 82 degrees is rendered, and between as F82 has it")
        color, edge = _conductor(p.read(use, "IOR"), p.read(use, "Extinction"))
    if use.node.distribution == "BECKMANN":
        use.note("has facets by Beckmann, which is not supported; GGX is rendered")
    _note_thin_film(use, p)
    inputs = {"baseColor": color, "specularTint": edge, "metallic": 1.0, "roughness": p.read(use, "Roughness")}
    tangent = _anisotropic(use, p, inputs, "Anisotropy", "Rotation")
    parameters = {"distribution": "multi-ggx" if use.node.distribution == "MULTI_GGX" else "ggx"}
    s.closures.append(Closure(use, "principled", weight, inputs, parameters, p.linked(use, "Normal"), tangent))


def _conductor(n: Value, k: Value) -> tuple[Value, Value]:
    """Reflectances of a metal with this index and extinction: straight on, and at a cosine of 1/7 over Schlick's there."""
    if not (is_constant(n) and is_constant(k)):
        return (0.8, 0.8, 0.8), WHITE
    c = 1.0 / 7.0

    def channel(n: float, k: float) -> tuple[float, float]:
        normal = ((n - 1) ** 2 + k * k) / ((n + 1) ** 2 + k * k)
        sin2 = 1 - c * c
        t = n * n - k * k - sin2
        r = math.sqrt(t * t + 4 * n * n * k * k)
        twice = 2 * c * math.sqrt(max(0.5 * (r + t), 0.0))
        s = (r + c * c - twice) / (r + c * c + twice)
        q = c * c * r + sin2 * sin2
        flat = 0.5 * s * (1 + (q - twice * sin2) / (q + twice * sin2))
        return normal, min(flat / (normal + (1 - normal) * (1 - c) ** 5), 1.0)

    normal, edge = zip(*map(channel, n, k))  # type: ignore[arg-type]
    return normal, edge


def _emission(use: NodeUse, s: Shading, weight: Value) -> None:
    s.emit(s.p.multiply(s.p.read(use, "Color"), s.p.read(use, "Strength")), weight)


# ours -> Blender's names
PRINCIPLED_3 = {
    "baseColor": "Base Color",
    "subsurface": "Subsurface",
    "subsurfaceColor": "Subsurface Color",
    "metallic": "Metallic",
    "specular": "Specular",
    "specularTint": "Specular Tint",
    "roughness": "Roughness",
    "sheen": "Sheen",
    "sheenTint": "Sheen Tint",
    "clearcoat": "Clearcoat",
    "clearcoatRoughness": "Clearcoat Roughness",
    "ior": "IOR",
    "transmission": "Transmission",
    "transmissionRoughness": "Transmission Roughness",
}
PRINCIPLED_4 = {
    "baseColor": "Base Color",
    "metallic": "Metallic",
    "roughness": "Roughness",
    "ior": "IOR",
    "alpha": "Alpha",
    "diffuseRoughness": "Diffuse Roughness",
    "subsurfaceWeight": "Subsurface Weight",
    "subsurfaceAnisotropy": "Subsurface Anisotropy",
    "specularIorLevel": "Specular IOR Level",
    "specularTint": "Specular Tint",
    "transmissionWeight": "Transmission Weight",
    "coatWeight": "Coat Weight",
    "coatRoughness": "Coat Roughness",
    "coatIor": "Coat IOR",
    "coatTint": "Coat Tint",
    "sheenWeight": "Sheen Weight",
    "sheenRoughness": "Sheen Roughness",
    "sheenTint": "Sheen Tint",
}


def _note_thin_film(use: NodeUse, p: Reader) -> None:
    if use.has("Thin Film Thickness") and not is_zero(p.read(use, "Thin Film Thickness")):
        use.note("has a 'Thin Film Thickness', which is not supported; it is left out")


def _anisotropic(use: NodeUse, p: Reader, inputs: dict[str, Value], amount: str, rotation: str) -> Value | None:
    """Adds what it takes to the inputs of the Principled shader, and returns the tangent."""
    anisotropic = p.read(use, amount)
    if is_zero(anisotropic):
        return None
    inputs |= {"anisotropic": anisotropic, "rotation": p.multiply(p.read(use, rotation), 2.0 * math.pi)}
    return _tangent(use, p)


def _principled(use: NodeUse, s: Shading, weight: Value) -> None:
    p = s.p
    names = PRINCIPLED_3 if compat.CYCLES == 3 else PRINCIPLED_4
    thin = use.has("Thin Wall") and p.number(use, "Thin Wall") != 0.0
    below = "Subsurface" if compat.CYCLES == 3 else "Subsurface Weight"
    if not thin and not is_zero(p.read(use, below)):
        use.note(f"has '{below}', which is not supported; it is rendered as diffuse")
    _note_thin_film(use, p)
    inputs = {ours: p.read(use, theirs) for ours, theirs in names.items() if use.has(theirs)}
    tangent = _anisotropic(use, p, inputs, "Anisotropic", "Anisotropic Rotation")
    parameters = _distribution(use)
    if thin:
        parameters["thinWall"] = True
    coat = "Clearcoat Normal" if compat.CYCLES == 3 else "Coat Normal"
    coat_normal = p.linked(use, coat)
    if coat_normal is not None:
        parameters["coatNormal"] = coat_normal
    alpha = p("clamp", p.read(use, "Alpha"), 0.0, 1.0)
    opaque = weight
    if compat.CYCLES == 3:
        through = p.multiply(weight, p.complement(alpha))
        if not is_zero(through):
            s.closures.append(Closure(use, "transparent", through, {"color": WHITE}))
        opaque = p.multiply(weight, alpha)
    if not is_zero(opaque):
        normal = p.linked(use, "Normal")
        s.closures.append(Closure(use, "principled", opaque, inputs, parameters, normal, tangent))
    light = p.multiply(p.read(use, compat.PRINCIPLED_EMISSION), p.read(use, "Emission Strength"))
    if (
        compat.CYCLES >= 4
        and not is_zero(light)
        and not (is_zero(inputs["coatWeight"]) and is_zero(inputs["sheenWeight"]))
    ):
        layers = [inputs[name] for name in ("coatWeight", "coatRoughness", "coatIor", "coatTint")]
        layers += [inputs[name] for name in ("sheenWeight", "sheenRoughness", "sheenTint")]
        normals = [p("normal") if given is None else given for given in (p.linked(use, "Normal"), coat_normal)]
        light = p("vector-multiply", light, p("below-layers", *layers, *normals, version=compat.CYCLES))
    s.emit(light, p.multiply(weight, alpha))


SHADERS: dict[str, Callable[[NodeUse, Shading, Value], None]] = {
    "WardBSDFNode": _ward,
    "ShaderNodeBsdfDiffuse": _diffuse,
    "ShaderNodeBsdfTranslucent": _translucent,
    "ShaderNodeBsdfTransparent": _transparent,
    "ShaderNodeBsdfGlossy": _glossy,
    "ShaderNodeBsdfAnisotropic": _glossy,
    "ShaderNodeBsdfGlass": _refractive("glass"),
    "ShaderNodeBsdfRefraction": _refractive("refraction"),
    "ShaderNodeBsdfVelvet": _sheen,
    "ShaderNodeBsdfSheen": _sheen,
    "ShaderNodeBsdfPrincipled": _principled,
    "ShaderNodeBsdfMetallic": _metallic,
    "ShaderNodeBsdfToon": _toon,
    "ShaderNodeBsdfHair": _as_diffuse,
    "ShaderNodeBsdfHairPrincipled": _as_diffuse,
    "ShaderNodeSubsurfaceScattering": _subsurface,
    "ShaderNodeHoldout": _holdout,
    "ShaderNodeEmission": _emission,
    "ShaderNodeBackground": _emission,
    "ShaderNodeAddShader": _add_shader,
    "ShaderNodeMixShader": _mix_shader,
}
