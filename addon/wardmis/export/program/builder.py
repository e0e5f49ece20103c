# SPDX-License-Identifier: GPL-3.0-or-later
"""A program in the making: operations as plain data, each once, with all that is constant computed at once."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model import LARGEST, ProgramData
from .folds import FOLDS
from .signatures import SIGNATURES


@dataclass(frozen=True)
class Result:
    """What an operation gives: `kind` is number or vector."""

    index: int
    kind: str


# what tells the normal of the surface, which `bend` changes
BY_NORMAL = {"normal", "object-normal", "reflection", "tangent", "tangent-uv", "vector-displacement"} | {
    f"normal-map-{space}" for space in ("tangent", "object", "world")
}

Vector = tuple[float, float, float]
Value = float | Vector | Result


@dataclass(frozen=True)
class Operation:
    name: str
    arguments: tuple[Value, ...]
    parameters: tuple[tuple[str, Any], ...]


def kind_of(value: Value) -> str:
    if isinstance(value, Result):
        return value.kind
    return "vector" if isinstance(value, tuple) else "number"


def is_constant(value: Value) -> bool:
    return not isinstance(value, Result)


def is_zero(value: Value) -> bool:
    return not isinstance(value, Result) and not np.any(value)


def constant(value: Any, kind: str) -> Value:
    """Of a number, or of at least three."""
    numbers = [float(x) for x in np.atleast_1d(value)]
    if kind == "number":
        return numbers[0]
    return (numbers[0], numbers[1], numbers[2]) if len(numbers) > 1 else (numbers[0],) * 3


class Builder:
    """builder("add", a, b) is the value of that operation of values or constants."""

    def __init__(self) -> None:
        self.operations: list[Operation] = []
        self._known: dict[Operation, int] = {}
        self.bent: Value | None = None  # the normal that bend() gave the surface

    def __call__(self, name: str, /, *arguments: Value, **parameters: Any) -> Value:
        kinds, result = SIGNATURES[name]
        if tuple(map(kind_of, arguments)) != kinds:
            raise TypeError(f"operation '{name}' takes {kinds}, not {tuple(map(kind_of, arguments))}")
        if arguments and name in FOLDS and all(map(is_constant, arguments)):
            with np.errstate(all="ignore"):
                return constant(
                    FOLDS[name](*(np.broadcast_to(np.array(a, float), 3) for a in arguments), **parameters), result
                )
        operation = Operation(name, tuple(map(_literal, arguments)), tuple(sorted(parameters.items())))
        if operation not in self._known:
            self._known[operation] = len(self.operations)
            self.operations.append(operation)
        return Result(self._known[operation], result)

    def vector(self, value: Value) -> Value:
        return self("vector", value) if kind_of(value) == "number" else value

    def add(self, a: Value, b: Value) -> Value:
        """Of two of one kind; as are products."""
        if is_zero(a) or is_zero(b):
            return b if is_zero(a) else a
        return self("add" if kind_of(a) == "number" else "vector-add", a, b)

    def multiply(self, a: Value, b: Value) -> Value:
        """Of a number or a vector, and a number."""
        if b == 1.0 or is_zero(a):
            return a
        if kind_of(a) == "vector":
            return (0.0, 0.0, 0.0) if is_zero(b) else self("vector-scale", a, b)
        if a == 1.0 or is_zero(b):
            return b
        return self("multiply", a, b)

    def complement(self, a: Value) -> Value:
        return self("subtract", 1.0, a)

    def bend(self, normal: Value) -> None:
        """From here on this is the surface's normal: of what is computed later, and of its closures."""
        self.bent = self("bend", normal)
        self._known = {o: index for o, index in self._known.items() if o.name not in BY_NORMAL}

    def program(self, wanted: Iterable[Value]) -> tuple[ProgramData | None, dict[int, int]]:
        """What computes these values, without what they do not need; and the new numbers of its operations."""
        needed = {value.index for value in (*wanted, self.bent) if isinstance(value, Result)}
        for index in range(len(self.operations) - 1, -1, -1):
            if index in needed:
                needed |= {a.index for a in self.operations[index].arguments if isinstance(a, Result)}
        number = {old: new for new, old in enumerate(sorted(needed))}
        operations = []
        for index in sorted(needed):
            operation = self.operations[index]
            entry: dict[str, Any] = {"op": operation.name}
            if operation.arguments:
                entry["in"] = [_argument(a, number) for a in operation.arguments]
            operations.append(entry | dict(operation.parameters))
        return (ProgramData(operations) if operations else None), number


def _literal(value: Value) -> Value:
    """One that a program may hold: what is not finite is 0, or as large as can be."""
    if isinstance(value, Result):
        return value
    if isinstance(value, tuple):
        x, y, z = (float(_literal(v)) for v in value)  # type: ignore[arg-type]
        return (x, y, z)
    return 0.0 if math.isnan(value) else min(max(value, -LARGEST), LARGEST)


def _argument(value: Value, number: dict[int, int]) -> Any:
    if isinstance(value, Result):
        return {"result": number[value.index]}
    return list(value) if isinstance(value, tuple) else value
