# SPDX-License-Identifier: GPL-3.0-or-later
"""The nodes that Blender 5 shares between kinds of trees, and takes out before Cycles sees a tree: menus, bundles, and the zones
that repeat, or that are handed on to be evaluated elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from .zones import Entered, same_item

if TYPE_CHECKING:
    from .tree import NodeUse

MOST_ITERATIONS = 4096

# An input, and what is entered to reach it; None: nothing, which is 0 and no shader.
Handed = tuple[Any, tuple[Entered, ...]]
NOTHING: Handed = (None, ())
GONE = {"BUNDLE", "CLOSURE", "MENU"}  # kinds of sockets of which no number can be made


def handed_on(use: NodeUse, output: Any) -> Handed | None:
    """What such a node hands on to an output; None for another node, or an output with a value of its own."""
    hands_on = NODES.get(use.node.bl_idname)
    return None if hands_on is None else hands_on(use, output)


def chosen(use: NodeUse) -> str | None:
    """The item of a Menu Switch, if it is the same everywhere."""
    source = use.source("Menu")
    if source.use is None:
        return None if source.socket is None else source.socket.default_value
    return source.use.node.value if source.use.node.bl_idname == "FunctionNodeInputMenu" else None


def _menu(use: NodeUse, output: Any) -> Handed | None:
    item = chosen(use)
    if output.identifier != "Output" or item is None:
        return None
    return next(((socket, use.entered) for socket in use.node.inputs[1:] if socket.name == item), NOTHING)


def _separate(use: NodeUse, output: Any) -> Handed:
    for bundle in _bundles(use):
        if output.name in bundle.node.inputs:
            return bundle.node.inputs[output.name], bundle.entered
    return NOTHING


def _bundles(use: NodeUse) -> Iterator[NodeUse]:
    """Those that a node takes apart or joins; of two with one item the first has it."""
    for source in use.sources(0):
        if source.use is None:
            continue
        kind = source.use.node.bl_idname
        if kind == "NodeJoinBundle":
            yield from _bundles(source.use)
        elif kind == "NodeCombineBundle":
            yield source.use


def _repeated(use: NodeUse, output: Any) -> Handed:
    """What leaves a repeat zone: from its last iteration, or what went into it where there is none."""
    start = use.zones.start(use.node)
    if start is None:
        return _alone(use)
    count = _iterations(use.other(start))
    if count <= 0:
        return same_item(start.inputs, output), use.entered
    return same_item(use.node.inputs, output), (*use.entered, Entered(use.node, count - 1))


def _iterations(use: NodeUse) -> int:
    """How often the zone is run that this node begins."""
    from .program.builder import is_constant  # late: programs are made of trees
    from .program.reader import Reader

    if not use.is_fixed(0):
        use.note("has Iterations that are no constant; there are none, as in Cycles")
        return 0
    value = Reader(use.owner.kind).read(use, 0)
    if not is_constant(value):
        use.note("has Iterations by a texture, which is constant to Cycles, and is not computed here; there are none")
        return 0
    count = int(value)  # type: ignore[arg-type]
    if count > MOST_ITERATIONS:
        use.note(f"has {count} iterations, of which {MOST_ITERATIONS} are the most; so many are used")
    return min(count, MOST_ITERATIONS)


def _repeat(use: NodeUse, output: Any) -> Handed | None:
    """What enters an iteration: what left the one before."""
    *outside, zone = use.entered or (None,)
    if zone is None or zone.node.bl_idname != "GeometryNodeRepeatOutput":
        return _alone(use)
    if output.identifier == "Iteration":
        return None
    given = same_item(zone.node.inputs, output)
    links = given.links if given.is_linked else ()
    # what an iteration does not touch need not be looked for in each of them
    untouched = any(link.from_socket == output and not link.is_muted for link in links)
    if zone.iteration == 0 or untouched:
        return same_item(use.node.inputs, output), tuple(outside)
    return given, (*outside, Entered(zone.node, zone.iteration - 1))


def _evaluated(use: NodeUse, output: Any) -> Handed:
    """What a closure zone that is handed on to this node gives for its inputs."""
    closure = use.source(0).use
    if closure is None or closure.node.bl_idname != "NodeClosureOutput":
        use.note("has no closure to evaluate; it gives nothing, as in Cycles")
        return NOTHING
    if closure.zones.start(closure.node) is None:
        return _alone(closure)
    if (closure.node, closure.entered) in ((entered.node, outside) for entered, outside in _callers(use)):
        use.note("evaluates a closure in itself; that gives nothing, as in Cycles")
        return NOTHING
    wanted = next((socket for socket in closure.node.inputs if socket.name == output.name), None)
    if wanted is None:
        use.note(f"finds no '{output.name}' in the closure that it evaluates; that is nothing, as in Cycles")
        return NOTHING
    return wanted, (*closure.entered, Entered(closure.node, caller=use))


def _callers(use: NodeUse) -> Iterator[tuple[Entered, tuple[Entered, ...]]]:
    """What is entered, from the inside, through the nodes that evaluate closures, each with what is around it."""
    entered = use.entered
    while entered:
        *outside, last = entered
        yield last, tuple(outside)
        entered = last.caller.entered if last.caller else tuple(outside)


def _given(use: NodeUse, output: Any) -> Handed:
    """What a closure's zone receives from the node that evaluates it."""
    caller = use.entered[-1].caller if use.entered else None
    if caller is None:
        return _alone(use)
    given = next((socket for socket in caller.node.inputs[1:] if socket.name == output.name), None)
    if given is None:
        caller.note(f"gives no '{output.name}' to the closure that it evaluates; that is nothing, as in Cycles")
        return NOTHING
    return given, caller.entered


def _alone(use: NodeUse) -> Handed:
    use.note("has no partner, with which it makes a zone; it gives nothing, as in Cycles")
    return NOTHING


def _converted(use: NodeUse, _output: Any) -> Handed:
    """What its sockets' kinds convert."""
    return use.node.inputs[0], use.entered


NODES: dict[str, Callable[[NodeUse, Any], Handed | None]] = {
    "GeometryNodeMenuSwitch": _menu,
    "NodeImplicitConversion": _converted,
    "NodeSeparateBundle": _separate,
    "GeometryNodeRepeatInput": _repeat,
    "GeometryNodeRepeatOutput": _repeated,
    "NodeClosureInput": _given,
    "NodeEvaluateClosure": _evaluated,
}

# Which Blender computes itself where all their inputs are constant, so that Cycles sees a constant.
COMPUTED = {
    "FunctionNodeInputBool",
    "FunctionNodeInputInt",
    "FunctionNodeInputVector",
    "GeometryNodeMenuSwitch",
    "GeometryNodeRepeatInput",
    "ShaderNodeBlackbody",
    "ShaderNodeClamp",
    "ShaderNodeCombineXYZ",
    "ShaderNodeFloatCurve",
    "ShaderNodeGamma",
    "ShaderNodeMapRange",
    "ShaderNodeMath",
    "ShaderNodeMix",
    "ShaderNodeMixRGB",
    "ShaderNodeRGBCurve",
    "ShaderNodeRadialTiling",
    "ShaderNodeSeparateXYZ",
    "ShaderNodeTexBrick",
    "ShaderNodeTexChecker",
    "ShaderNodeTexGabor",
    "ShaderNodeTexGradient",
    "ShaderNodeTexMagic",
    "ShaderNodeTexNoise",
    "ShaderNodeTexVoronoi",
    "ShaderNodeTexWave",
    "ShaderNodeTexWhiteNoise",
    "ShaderNodeValToRGB",
    "ShaderNodeValue",
    "ShaderNodeVectorCurve",
    "ShaderNodeVectorMath",
    "ShaderNodeVectorRotate",
}


def is_computed(use: NodeUse) -> bool:
    """Whether Blender itself computes the node."""
    kind, known, key = use.node.bl_idname, use.owner.context.computed, (use.owner.place, use.place)
    if kind not in COMPUTED or kind in {"GeometryNodeMenuSwitch", "GeometryNodeRepeatInput"}:
        return kind in COMPUTED  # of the latter the choice, and the number of the iteration
    if key not in known:
        known[key] = all(use.is_fixed(i) for i, socket in enumerate(use.node.inputs) if socket.enabled)
    return bool(known[key])
