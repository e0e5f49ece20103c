# SPDX-License-Identifier: GPL-3.0-or-later
"""What Cycles still reads of a node tree once it has folded what is constant: which nodes reach the output, and by which outputs.

It computes nodes whose inputs are all constant, passes by those that change nothing, and then leaves out all that the output does
not hang on. Only then does it ask whether an image's Alpha is used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from ... import compat
from ..socket_value import NotFinite, own_value
from ..tree import NodeUse, Owner, Source, output_use
from .builder import Result, Value, constant
from .reader import Reader, kind_of_socket

ENDS = ("Surface", "Volume", "Displacement")  # of an output node

# What has a value as soon as all its inputs have one
COMPUTED = {
    "ShaderNodeRGB",
    "ShaderNodeValue",
    "ShaderNodeMath",
    "ShaderNodeVectorMath",
    "ShaderNodeMix",
    "ShaderNodeMixRGB",
    "ShaderNodeInvert",
    "ShaderNodeGamma",
    "ShaderNodeBrightContrast",
    "ShaderNodeRGBCurve",
    "ShaderNodeVectorCurve",
    "ShaderNodeFloatCurve",
    "ShaderNodeValToRGB",
    "ShaderNodeClamp",
    "ShaderNodeRGBToBW",
    "ShaderNodeSeparateColor",
    "ShaderNodeSeparateRGB",
    "ShaderNodeSeparateHSV",
    "ShaderNodeSeparateXYZ",
    "ShaderNodeCombineColor",
    "ShaderNodeCombineRGB",
    "ShaderNodeCombineHSV",
    "ShaderNodeCombineXYZ",
    "ShaderNodeBlackbody",
    "ShaderNodeMapping",
}
# and what has one whatever its inputs are
SHARED = {
    "FunctionNodeInputBool",
    "FunctionNodeInputInt",
    "FunctionNodeInputVector",
    "GeometryNodeMenuSwitch",
    "GeometryNodeRepeatInput",
}


@dataclass(frozen=True)
class Constant:
    """`value`: (3,); None where it is not known here."""

    value: np.ndarray | None


@dataclass(frozen=True)
class Link:
    """To an output of a node that stays. `kinds`: those of the sockets that the value goes through."""

    use: NodeUse
    socket: Any
    kinds: tuple[str, ...]

    @property
    def place(self) -> tuple[Any, ...]:
        return (*self.use.place, self.socket.identifier)

    @property
    def identity(self) -> tuple[Any, ...]:
        """Equal where Cycles has one link: conversions, which are nodes there, are not shared."""
        return (self.place, self.kinds) if len(set(self.kinds)) == 1 else (id(self),)


Place = tuple[Any, ...]
Folded = Constant | Link | None  # None: no shader


class Folding:
    """Of one tree. Raises RecursionError where its nodes are linked in a circle."""

    def __init__(self, owner: Owner, tree: Any) -> None:
        self._inputs: dict[tuple[Any, ...], Folded] = {}
        self._outputs: dict[Place, Constant | int | tuple[int, ...] | None] = {}
        self._visited: set[Place] = set()
        self._open: set[Place] = set()  # inputs being read
        self._alphas: set[Any] = set()
        for end in ENDS:
            use = output_use(tree, end, owner)
            if use is not None and use.has(end):
                self._visit(use, list(use.node.inputs).index(use.node.inputs[end]))

    def shows_alpha(self, use: NodeUse) -> bool:
        """Whether the Alpha of this image node, or of one that Cycles makes one with it, is used."""
        return self._image(use) in self._alphas

    def _visit(self, use: NodeUse, key: int) -> None:
        pending = [(use, key)]
        while pending:
            link = self._input(*pending.pop())
            if not isinstance(link, Link) or link.place in self._visited:
                continue
            self._visited.add(link.place)
            if link.use.node.bl_idname == "ShaderNodeTexImage" and link.socket.name == "Alpha":
                self._alphas.add(self._image(link.use))
            kept = self._outputs[link.place]
            inputs = kept if isinstance(kept, tuple) else _enabled(link.use)
            pending += [(link.use, key) for key in inputs]

    def _image(self, use: NodeUse) -> Any:
        """Equal for nodes that show the same image at the same place, of which Cycles makes one."""
        vector = self._input(use, 0)
        node = use.node
        where: Any = vector.place if isinstance(vector, Link) else ()
        if (
            isinstance(vector, Link)
            and vector.use.node.bl_idname == "ShaderNodeTexCoord"
            and vector.socket.name == "UV"
        ):
            where = ()  # what an image has anyway
        mapping, user = node.texture_mapping, node.image_user
        return (
            None if node.image is None else node.image.name_full,
            (node.interpolation, node.extension, node.projection, node.projection_blend),
            (mapping.vector_type, *mapping.translation, *mapping.rotation, *mapping.scale),
            (mapping.mapping_x, mapping.mapping_y, mapping.mapping_z),
            (user.frame_start, user.frame_duration, user.frame_offset, user.use_cyclic),
            where,
        )

    # ---- folding ---------------------------------------------------------------------------------------------------

    def _input(self, use: NodeUse, key: int) -> Folded:
        """What an input receives."""
        place = (*use.place, key)
        if place in self._open:
            raise RecursionError
        if place not in self._inputs:
            self._open.add(place)
            self._inputs[place] = self._folded_input(use, key)
            self._open.remove(place)
        return self._inputs[place]

    def _folded_input(self, use: NodeUse, key: int) -> Folded:
        source = use.source(key)
        if source.is_nothing:
            return None
        if source.use is None:
            return _as_kinds(use, _own(use, source.socket), source.kinds)
        link = Link(source.use, source.socket, source.kinds)
        folded = self._output(link)
        if isinstance(folded, tuple):
            return link
        given: Folded = self._input(source.use, folded) if isinstance(folded, int) else folded
        if isinstance(given, Link):
            return Link(given.use, given.socket, (*given.kinds, *source.kinds[1:]))
        return None if given is None else _as_kinds(use, given, source.kinds)

    def _output(self, link: Link) -> Constant | int | tuple[int, ...] | None:
        """A constant, the number of the input that is handed on, the numbers of those that count, or None for no shader."""
        if link.place not in self._outputs:
            self._outputs[link.place] = self._folded_output(link.use, link.socket)
        return self._outputs[link.place]

    def _folded_output(self, use: NodeUse, output: Any) -> Constant | int | tuple[int, ...] | None:
        kind = use.node.bl_idname
        keys = _enabled(use)
        if kind in SHARED:
            return _computed(use, output, {})
        if kind not in COMPUTED and kind not in FOLDS:
            return keys
        inputs = {key: self._input(use, key) for key in keys}
        constants = {key: x for key, x in inputs.items() if isinstance(x, Constant)}
        if kind in COMPUTED and len(constants) == len(inputs):
            return _computed(use, output, constants)
        return FOLDS[kind](use.node, list(inputs.items())) if kind in FOLDS else keys


@dataclass(frozen=True)
class _WithConstants(NodeUse):
    """A node with these as what its inputs receive."""

    constants: Any

    def source(self, key: str | int) -> Source:
        index = key if isinstance(key, int) else list(self.node.inputs).index(self.node.inputs[key])
        socket = self.node.inputs[index]
        given = SimpleNamespace(
            default_value=self.constants[index], name=socket.name, type=socket.type, hide_value=False
        )
        return Source(given, None, (socket.type,))


def _computed(use: NodeUse, output: Any, constants: dict[int, Constant]) -> Constant:
    from .nodes import NODES  # late: one of them asks whether its alpha is used

    if any(x.value is None for x in constants.values()):
        return Constant(None)
    fixed = _WithConstants(use.node, use.entered, use.owner, {key: x.value for key, x in constants.items()})
    try:
        return _known(NODES[use.node.bl_idname](fixed, output, Reader(use.owner.kind)))
    except NotFinite:
        return Constant(None)


def _known(value: Value | None) -> Constant:
    return Constant(None if value is None or isinstance(value, Result) else np.broadcast_to(value, 3))


def _own(use: NodeUse, socket: Any) -> Constant:
    if socket is None:
        return Constant(np.zeros(3))
    try:
        return Constant(own_value(use, socket))
    except NotFinite:
        return Constant(None)


def _as_kinds(use: NodeUse, given: Constant, kinds: tuple[str, ...]) -> Constant:
    if given.value is None or not kinds:
        return given
    return _known(Reader(use.owner.kind).converted(constant(given.value, kind_of_socket(kinds[0])), kinds))


def _enabled(use: NodeUse) -> tuple[int, ...]:
    return tuple(i for i, socket in enumerate(use.node.inputs) if socket.enabled)


# ---- what nodes fold to, some of whose inputs are not constant ------------------------------------------------------

Inputs = list[tuple[int, Folded]]  # those in use: number, and what it receives
Kept = tuple[int, ...]


def _all(inputs: Inputs) -> Kept:
    return tuple(key for key, _ in inputs)


def _is(x: Folded, number: float) -> bool:
    return isinstance(x, Constant) and x.value is not None and bool((x.value == number).all())


def _constant(number: float) -> Constant:
    return Constant(np.full(3, number))


def _same(a: Folded, b: Folded) -> bool:
    if isinstance(a, Link) and isinstance(b, Link):
        return a.identity == b.identity
    if not (isinstance(a, Constant) and isinstance(b, Constant)) or a.value is None or b.value is None:
        return False
    return np.array_equal(a.value, b.value)


def _operation(node: Any, inputs: Inputs) -> Any:
    """Of numbers or vectors."""
    if len(inputs) == 1:
        return _all(inputs)
    (first, a), (second, b) = inputs[0], inputs[-1 if node.operation == "SCALE" else 1]
    vectors = node.bl_idname == "ShaderNodeVectorMath"
    kind = node.operation
    passed: int | None = None
    if kind == "ADD":
        passed = second if _is(a, 0) else first if _is(b, 0) else None
    elif kind == "SUBTRACT":
        passed = first if _is(b, 0) else None
    elif kind in {"MULTIPLY", "SCALE"}:
        if _is(a, 0) or _is(b, 0):
            return _constant(0)
        passed = second if _is(a, 1) and kind == "MULTIPLY" else first if _is(b, 1) else None
    elif kind == "DIVIDE":
        if _is(a, 0) or (vectors and _is(b, 0)):
            return _constant(0)
        passed = first if _is(b, 1) else None
    elif kind in {"DOT_PRODUCT", "CROSS_PRODUCT"} and (_is(a, 0) or _is(b, 0)):
        return _constant(0)
    elif kind == "POWER" and not vectors:
        if _is(a, 1) or _is(b, 0):
            return _constant(1)
        passed = first if _is(b, 1) else None
    if passed is None:
        return _all(inputs)
    return passed if vectors or not node.use_clamp else (passed,)


def _mix(node: Any, inputs: Inputs) -> Any:
    if node.bl_idname == "ShaderNodeMixRGB":
        return _blend(node.blend_type, inputs, True, node.use_clamp)
    if node.data_type == "RGBA":
        return _blend(node.blend_type, inputs, node.clamp_factor, node.clamp_result)
    uniform = node.data_type == "FLOAT" or (node.data_type == "VECTOR" and node.factor_mode == "UNIFORM")
    return _blend("MIX", inputs, node.clamp_factor, False) if uniform and compat.MIXED_NUMBERS_FOLD else _all(inputs)


def _blend(blend: str, inputs: Inputs, clamp_factor: bool, clamp: bool) -> Any:
    (_, t), (first, a), (second, b) = inputs
    if clamp_factor and isinstance(t, Constant) and t.value is not None:
        t = Constant(np.clip(t.value, 0, 1))

    def only(key: int, x: Folded) -> Any:
        if clamp and isinstance(x, Constant):
            return Constant(None if x.value is None else np.clip(x.value, 0, 1))
        return (key,) if clamp else key

    passes_first = (
        (_is(t, 0) and blend not in {"LIGHTEN", "DODGE", "BURN"})
        or (blend == "MIX" and _same(a, b))
        or (blend in {"ADD", "SUBTRACT"} and _is(b, 0))
        or (blend in {"MULTIPLY", "DIVIDE"} and _is(b, 1))
    )
    passes_second = _is(t, 1) and (
        blend == "MIX" or (blend == "ADD" and _is(a, 0)) or (blend == "MULTIPLY" and _is(a, 1))
    )
    if passes_second and not (blend == "MIX" and _same(a, b)):  # before it is asked what is added or multiplied
        return only(second, b)
    if passes_first:
        return only(first, a)
    nothing = (
        (blend in {"MULTIPLY", "DIVIDE"} and _is(a, 0))
        or (blend == "MULTIPLY" and _is(b, 0) and _is(t, 1))
        or (blend == "SUBTRACT" and isinstance(a, Link) and _same(a, b) and _is(t, 1))
    )
    return _constant(0) if nothing else _all(inputs)


def _by_share(_node: Any, inputs: Inputs) -> Any:
    """Of a node that does nothing where its first input is 0."""
    return inputs[1][0] if _is(inputs[0][1], 0) else _all(inputs)


def _gamma(_node: Any, inputs: Inputs) -> Any:
    (first, color), (_, exponent) = inputs
    if _is(color, 1) or _is(exponent, 0):
        return _constant(1)
    return first if _is(exponent, 1) else _all(inputs)


def _mapping(node: Any, inputs: Inputs) -> Any:
    (first, _), *others, (_, scale) = inputs
    if _is(scale, 0):
        return _constant(0)
    moves_nothing = _is(scale, 1) and all(_is(x, 0) for _, x in others)
    return first if moves_nothing and node.vector_type != "NORMAL" else _all(inputs)


def _bump(node: Any, inputs: Inputs) -> Any:
    height, normal = list(node.inputs).index(node.inputs["Height"]), list(node.inputs).index(node.inputs["Normal"])
    return _all(inputs) if isinstance(dict(inputs)[height], Link) else (normal,)


def _shines(x: Folded) -> bool:
    """Whether there is a shader: a colour in its place is one of light."""
    return x is not None and not _is(x, 0)


def _emission(_node: Any, inputs: Inputs) -> Any:
    return None if _is(inputs[0][1], 0) or _is(inputs[1][1], 0) else _all(inputs)


def _add_shader(_node: Any, inputs: Inputs) -> Any:
    (first, a), (second, b) = inputs
    if not _shines(a):
        return second if _shines(b) else None
    return _all(inputs) if _shines(b) else first


def _mix_shader(_node: Any, inputs: Inputs) -> Any:
    (_, t), (first, a), (second, b) = inputs
    if not _shines(a) and not _shines(b):
        return None
    if isinstance(a, Link) and _same(a, b):
        return first
    if isinstance(t, Constant) and t.value is not None and not 0 < t.value[0] < 1:
        key, x = (first, a) if t.value[0] <= 0 else (second, b)
        return key if _shines(x) else None
    return _all(inputs)


FOLDS: dict[str, Callable[[Any, Inputs], Any]] = {
    "ShaderNodeMath": _operation,
    "ShaderNodeVectorMath": _operation,
    "ShaderNodeMix": _mix,
    "ShaderNodeMixRGB": _mix,
    "ShaderNodeInvert": _by_share,
    "ShaderNodeRGBCurve": _by_share,
    "ShaderNodeVectorCurve": _by_share,
    "ShaderNodeFloatCurve": _by_share,
    "ShaderNodeGamma": _gamma,
    "ShaderNodeMapping": _mapping,
    "ShaderNodeBump": _bump,
    "ShaderNodeEmission": _emission,
    "ShaderNodeBackground": _emission,
    "ShaderNodeAddShader": _add_shader,
    "ShaderNodeMixShader": _mix_shader,
}
