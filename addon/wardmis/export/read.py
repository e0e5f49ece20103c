# SPDX-License-Identifier: GPL-3.0-or-later
"""What an input socket receives."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .tree import NodeUse
from .value import BLACK, NotFinite, Value, calculator, constant, converted

# By the node's type: what it gives at one of its outputs; None: this setting of it is not understood. converters.py fills it.
CONVERTERS: dict[str, Callable[[NodeUse, Any], Value | None]] = {}
# What stands in for a node that is not understood, and what that is in words. neutral.py fills it.
NEUTRAL: dict[str, Callable[[NodeUse, Any], tuple[Value, str]]] = {}


def read(use: NodeUse, key: str | int) -> Value:
    source = use.source(key)
    if source.use is None:
        value = BLACK if source.socket is None else own_value(use, source.socket)
    else:
        value = _given(source.use, source.socket) or own_value(use, use.node.inputs[key])
    return converted(calculator(use), value, source.kinds)


def _given(use: NodeUse, output: Any) -> Value | None:
    """What a node gives; None, and a note, where nothing can be said about it."""
    kind = use.node.bl_idname
    value = CONVERTERS[kind](use, output) if kind in CONVERTERS else None
    if value is not None:
        return value
    if kind not in NEUTRAL:
        use.note("is not supported as a colour or number; the constant of the input that it feeds is used instead")
        return None
    value, what = NEUTRAL[kind](use, output)
    use.note(f"is not supported as a colour or number; {what} is used instead")
    return value


def read_number(use: NodeUse, key: str | int) -> float:
    """What an input socket receives where only a constant will do."""
    value = read(use, key)
    if value.lookup is not None:
        use.note(f"needs a constant as its '{use.node.inputs[key].name}'; the mean of the texture is used instead")
    return float(value.mean().factor[0])


def own_value(use: NodeUse, socket: Any) -> Value:
    """What is typed into a socket: of an input, or of a node that is nothing but a value."""
    if not hasattr(socket, "default_value") or isinstance(socket.default_value, str):
        return BLACK
    value = constant(socket.default_value)
    if not np.isfinite(value.factor).all():
        instead = "the material is rendered as magenta" if use.owner.kind == "material" else "it gives no light"
        use.note(f"has a '{socket.name}' that is not a finite number; {instead}")
        raise NotFinite
    return value
