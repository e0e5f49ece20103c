# SPDX-License-Identifier: GPL-3.0-or-later
"""What a shader tree stands for -> a material: in the short form where that says it, else as a list of closures."""

from __future__ import annotations

from typing import Any

from ... import compat
from ..model import ClosureData, ColorInput, MaterialData, ProgramData, ScalarInput, TextureUse
from .builder import Result, Value, constant, is_constant
from .closures import BLACK, Closure, Shading
from .reader import Reader

MOST_OPERATIONS = 4096

# inputs of closures that are colours; the others are numbers
COLORS = {"color", "baseColor", "subsurfaceColor", "coatTint"}


class Writer:
    """Turns values into inputs of a material, of which the program's `needed` then become its operations."""

    def __init__(self, p: Reader) -> None:
        self.p = p
        self.needed: list[Value] = []
        self._uses: list[Any] = []  # what holds the number of a value, to be numbered anew

    def color(self, value: Value, least: float = float("-inf")) -> ColorInput:
        """`least`: what is below is cut. A surface that reflects less than nothing reflects nothing."""
        value = self.p.vector(value)
        factor = (1.0, 1.0, 1.0)
        while isinstance(value, Result) and self.p.operations[value.index].name == "vector-scale":
            scaled, by = self.p.operations[value.index].arguments
            if isinstance(by, Result):
                break
            value, factor = scaled, tuple(f * by for f in factor)  # type: ignore[operator, assignment]
        if isinstance(value, Result):
            plain = self._texture(value)
            return ColorInput(factor, plain) if plain else self._held(ColorInput(factor), value)
        r, g, b = (c if c != c else max(c, least) for c in value)  # type: ignore[union-attr]  # a NaN stays one
        return ColorInput((r, g, b))

    def scalar(self, value: Value) -> ScalarInput:
        if isinstance(value, Result):
            return self._held(ScalarInput(1.0), value)
        return ScalarInput(float(value))  # type: ignore[arg-type]

    def vector(self, value: Value) -> Any:
        """A normal: a constant one, too, is a value of the program."""
        if is_constant(value):
            x, y, z = value  # type: ignore[misc]
            value = self.p("vector-add", self.p("vector-scale", self.p("true-normal"), 0.0), (x, y, z))
        return self._held(ColorInput(), value)

    def _held(self, held: Any, value: Value) -> Any:
        assert isinstance(value, Result)
        self.needed.append(value)
        held.result = value.index
        self._uses.append(held)
        return held

    def _texture(self, value: Result) -> TextureUse | None:
        """Of nothing but an image at the mesh's own UVs, which needs no program."""
        operation = self.p.operations[value.index]
        parameters = dict(operation.parameters)
        if operation.name != "image" or set(parameters) != {"texture"} or not isinstance(parameters["texture"], int):
            return None
        transform = _of_own_uvs(self.p, operation.arguments[0])
        return None if transform is None else TextureUse(parameters["texture"], transform=transform)

    def program(self) -> ProgramData | None:
        program, number = self.p.program(self.needed)
        for use in self._uses:
            use.result = number[use.result]
        return program


def _of_own_uvs(p: Reader, vector: Value) -> tuple[float, float, float, float, float, float] | None:
    """u' = a u + b v + c, v' = d u + e v + f, if that is what it is."""
    if not isinstance(vector, Result):
        return None
    operation = p.operations[vector.index]
    if operation.name == "uv" and not operation.parameters:
        return (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    if operation.name != "mapping":
        return None
    before = operation.arguments[0]
    origin = p.operations[before.index] if isinstance(before, Result) else None
    if origin is None or origin.name != "uv" or origin.parameters:
        return None
    a, b, _, c, d, e, _, f = dict(operation.parameters)["matrix"][:8]
    return (a, b, c, d, e, f)


def material_of(name: str, shading: Shading) -> MaterialData:
    p, closures = shading.p, shading.closures
    data = _short(name, p, closures)
    writer = Writer(p)
    if data is None:
        data = MaterialData(name)
        data.closures = [_closure(writer, c) for c in closures]
    else:
        _write_short(writer, data, closures)
    data.emission = writer.color(shading.emission)
    data.program = writer.program()
    return data


# ---- the short form: Lambert and one lobe of Ward's -----------------------------------------------------------------


def _short(name: str, p: Reader, closures: list[Closure]) -> MaterialData | None:
    wards = [c for c in closures if c.type == "ward"]
    simple = all(c.type == "ward" or (c.type == "diffuse" and "roughness" not in c.inputs) for c in closures)
    normals = {c.normal for c in closures}
    if not simple or len(normals) > 1 or len(set(map(_shape, wards))) > 1:
        return None
    if not wards and (normals - {None} or p.bent is not None):  # which Cycles' rules for light at other normals are for
        return None
    if wards and not is_constant(wards[0].inputs["rotation"]):
        return None
    return MaterialData(name)


def _shape(ward: Closure) -> tuple[Any, ...]:
    return (*(ward.inputs[name] for name in ("alphaX", "alphaY", "rotation")), ward.parameters["variant"])


def _write_short(writer: Writer, data: MaterialData, closures: list[Closure]) -> None:
    p = writer.p
    diffuse: Value = BLACK
    specular: Value = BLACK
    for closure in closures:
        part = p.multiply(closure.inputs["color"], closure.weight)
        if closure.type == "diffuse":
            diffuse = p.add(diffuse, part)
            continue
        specular = p.add(specular, part)
        data.alpha_x, data.alpha_y = (_alpha(writer, closure.inputs[name]) for name in ("alphaX", "alphaY"))
        data.rotation, data.variant = float(closure.inputs["rotation"]), closure.parameters["variant"]  # type: ignore[arg-type]
    data.diffuse, data.specular = writer.color(diffuse, 0.0), writer.color(specular, 0.0)
    normal = closures[0].normal if closures else None
    if normal is not None:
        data.normal = writer.vector(normal)


def _alpha(writer: Writer, value: Value) -> ScalarInput:
    if isinstance(value, float) and value < 0.0:
        value = 0.0
    return writer.scalar(value)


# ---- closures -------------------------------------------------------------------------------------------------------


def _closure(writer: Writer, closure: Closure) -> ClosureData:
    inputs: dict[str, Any] = {}
    for name, value in closure.inputs.items():
        is_color = (
            name in COLORS
            or (not is_constant(value) and isinstance(value, Result) and value.kind == "vector")
            or isinstance(value, tuple)
        )
        inputs[name] = writer.color(value) if is_color else writer.scalar(value)
    parameters = {"version": compat.CYCLES, **closure.parameters}
    coat_normal = parameters.pop("coatNormal", None)
    weight = closure.weight
    return ClosureData(
        closure.type,
        None if weight == 1.0 else writer.color(constant(weight, "vector") if is_constant(weight) else weight),
        inputs,
        parameters,
        None if closure.normal is None else writer.vector(closure.normal),
        None if coat_normal is None else writer.vector(coat_normal),
        None if closure.tangent is None else writer.vector(closure.tangent),
    )
