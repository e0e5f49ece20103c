# SPDX-License-Identifier: GPL-3.0-or-later
"""Closures that the renderer has no lobes for, as Lambert's and Ward's."""

from __future__ import annotations

from ... import compat
from .builder import Value, is_zero
from .closures import BLACK, Closure, Shading
from .reader import Reader


def reduce(shading: Shading) -> None:
    reduced: list[Closure] = []
    for closure in shading.closures:
        reduced += _reduced(shading.p, closure)
    wards = [c for c in reduced if c.type == "ward"]
    if len({str((w.inputs["alphaX"], w.inputs["alphaY"], w.inputs["rotation"], w.parameters)) for w in wards}) > 1:
        wards[-1].use.note("is a second glossy lobe, which is not supported; it is as rough as the first")
    for ward in wards[1:]:
        ward.inputs |= {name: wards[0].inputs[name] for name in ("alphaX", "alphaY", "rotation")}
        ward.parameters = wards[0].parameters
    if len({c.normal for c in reduced}) > 1:
        reduced[-1].use.note("has a normal of its own, which is not supported; that of the first shader is used")
    for closure in reduced:
        closure.normal = reduced[0].normal
    shading.closures = reduced


def _reduced(p: Reader, c: Closure) -> list[Closure]:
    def diffuse(color: Value) -> Closure:
        return Closure(c.use, "diffuse", c.weight, {"color": color}, {}, c.normal)

    def ward(color: Value, x: Value, y: Value) -> Closure:
        inputs = {"color": color, "alphaX": x, "alphaY": y, "rotation": c.inputs.get("rotation", 0.0)}
        if not isinstance(inputs["rotation"], float):
            inputs["rotation"] = 0.0
        return Closure(c.use, "ward", c.weight, inputs, {"variant": "ward-gmd"}, c.normal)

    if c.type == "ward" or (c.type == "diffuse" and "roughness" not in c.inputs):
        return [c]
    instead = {
        "glossy": "",
        "principled": "",
        "diffuse": "as Lambertian, without its roughness (Oren-Nayar)",
        "transparent": "as black",
    }
    as_what = instead.get(c.type, "as glossy" if c.type in {"glass", "refraction"} else "as diffuse")
    if as_what:
        c.use.note(f"is not supported; rendered {as_what}")
    if c.type == "principled":
        for name in compat.PRINCIPLED_EXTRAS:
            if c.use.has(name) and not is_zero(p.read(c.use, name)):
                c.use.note(f"has '{name}', which is not supported; it is left out")
        if p.read(c.use, "Alpha") != 1.0:
            c.use.note("has an alpha below 1, which is not supported; it is rendered darker")
    if c.type == "glossy":
        return [ward(c.inputs["color"], c.inputs["alphaX"], c.inputs["alphaY"])]
    if c.type in {"glass", "refraction"}:
        return [ward(c.inputs["color"], c.inputs["alpha"], c.inputs["alpha"])]
    if c.type != "principled":
        return [] if c.type == "transparent" else [diffuse(c.inputs["color"])]
    i = c.inputs
    dielectric = p.complement(i["metallic"])
    if compat.CYCLES == 3:
        reflectance = p("multiply", i["specular"], 0.08)
        tint: Value = (1.0, 1.0, 1.0)
        below: Value = 1.0
    else:
        ratio = p("divide", p("subtract", i["ior"], 1.0), p("add", i["ior"], 1.0))
        reflectance = p("multiply", i["specularIorLevel"], p("multiply", 2.0, p("multiply", ratio, ratio)))
        tint = i["specularTint"]
        below = p.complement(reflectance)
    gloss = p.multiply(p.multiply(tint, reflectance), dielectric)
    metal = p.multiply(i["baseColor"], i["metallic"])
    alpha = p("multiply", i["roughness"], i["roughness"])
    aspect = p("sqrt", p("subtract", 1.0, p("multiply", 0.9, p("clamp", i["anisotropic"], 0.0, 1.0))))
    x, y = p("divide", alpha, aspect), p("multiply", alpha, aspect)
    parts = [diffuse(p.multiply(p.multiply(i["baseColor"], dielectric), below)), ward(p.add(metal, gloss), x, y)]
    return [part for part in parts if part.inputs["color"] != BLACK]
