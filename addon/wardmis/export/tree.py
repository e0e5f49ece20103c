# SPDX-License-Identifier: GPL-3.0-or-later
"""A node tree as Cycles sees it: without reroutes, muted nodes and the borders of groups."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from .. import compat
from . import unrolled
from .context import ExportContext
from .zones import Entered, Zones, same_item

RAYS = ("camera", "diffuse", "glossy", "transmission")  # kinds of ray that may see different skies
LONGEST_CHAIN = 100_000  # of reroutes, muted nodes, and borders of groups and zones; a longer one is a circle


@dataclass(frozen=True)
class Owner:
    """Whose nodes they are: the `kind` is material, world or light; `place` begins every note about them.

    `ray`: the kind of ray, of RAYS, for which a world's are evaluated.
    """

    kind: str
    place: str
    context: ExportContext
    ray: str | None = None


@dataclass(frozen=True)
class Source:
    """What an input receives: the value of `socket`, converted to each of the `kinds` in turn.

    `use`: the node whose output `socket` is; None where it is an input whose own value holds. `socket` None: nothing, which is 0.
    """

    socket: Any
    use: NodeUse | None
    kinds: tuple[str, ...]

    @property
    def is_nothing(self) -> bool:
        """Where a shader is wanted: no shader, and no colour in its place."""
        return self.use is None and (self.socket is None or self.socket.type == "SHADER")


@dataclass(frozen=True)
class NodeUse:
    """A node, and what one enters to reach it: a group may be used several times, with other inputs, and so may a zone."""

    node: Any
    entered: tuple[Entered, ...]
    owner: Owner

    @property
    def place(self) -> tuple[Any, ...]:
        return (self.node.as_pointer(), *(entered.place for entered in self.entered))

    @property
    def zones(self) -> Zones:
        return self._zones_of(self.node)

    def other(self, node: Any) -> NodeUse:
        """Another node at the same place."""
        return NodeUse(node, self.entered, self.owner)

    def note(self, text: str) -> None:
        label = self.node.bl_label
        self.owner.context.note(f"{self.owner.place}: node '{self.node.name}' ({label}) {text}")

    def has(self, name: str) -> bool:
        return name in self.node.inputs

    def source(self, key: str | int) -> Source:
        socket = self.node.inputs[key]
        return self._follow(socket, self._link_to(socket))

    def sources(self, key: str | int) -> list[Source]:
        """The same of an input that takes several links."""
        socket = self.node.inputs[key]
        return [self._follow(socket, link) for link in _links_to(socket)]

    def is_linked(self, name: str) -> bool:
        """Whether something feeds the input of this name, if there is one."""
        if not self.has(name):
            return False
        source = self.source(name)
        if source.use is not None or source.is_nothing or not compat.NODE_TREES_ARE_INLINED:
            return source.use is not None
        return not self.is_left_open(name, source)

    def is_left_open(self, key: str | int, source: Source) -> bool:
        """Whether Cycles finds nothing linked to an input, which receives `source`, so that it links there what it has for that.

        Since Blender 5.0 it finds the value of a group's or a zone's input that nothing feeds, unless neither shows a value.
        """
        own = self.node.inputs[key]
        if source.use is not None or source.socket is None or source.socket == own:
            return source.use is None and source.socket == own
        hidden = own.hide_value and source.socket.hide_value
        return compat.NODE_TREES_ARE_INLINED and hidden and not unrolled.is_computed(self)

    def is_fixed(self, key: str | int) -> bool:
        """Whether Blender itself knows what an input receives, before it gives the tree to Cycles."""
        source = self.source(key)
        if source.use is not None:
            return unrolled.is_computed(source.use)
        is_texture = self.node.bl_idname.startswith("ShaderNodeTex")
        return not (is_texture and source.socket == self.node.inputs[key] and source.socket.hide_value)

    def _follow(self, own: Any, link: Any) -> Source:
        """From input to input against the links, through everything that only hands on.

        RecursionError where they go in a circle. Before Blender 5.0 each thing on the way converts to its own type and, if nothing is behind it, is 0; later ones are gone
        before anything is evaluated, and convert only what Blender itself knows.
        """
        entered, socket, target = self.entered, own, own
        kinds: list[str] = [own.type]  # from the last to the first
        known = 1  # how many of them are on the way to `target`
        hands_on = False  # whether `socket` belongs to a reroute or a muted node
        nothing = Source(None, None, (own.type,))
        for _ in range(LONGEST_CHAIN):
            fault = self._zones_of(socket.node).fault
            if fault:
                self.note(f"hangs on a node tree of which Blender makes nothing, because {fault}")
                return nothing
            node: Any = link.from_node if link else None
            output: Any = link.from_socket if link else None
            through = _handed_on(node, output) if link else None
            if through is not None:
                kinds.append(output.type)
                socket, hands_on = through, True
            elif node is None or node.mute:  # no way through a muted node: as if there were no link
                if compat.NODE_TREES_ARE_INLINED:
                    return Source(target, None, tuple(reversed(kinds[:known])))
                return Source(None if hands_on else socket, None, tuple(reversed(kinds)))
            else:
                use = NodeUse(node, self._zones_of(node).left(entered, node), self.owner)
                handed = use._handed_on(output)
                if handed is None:
                    return self._given(own, target, kinds, output, use)
                socket, entered = handed
                if socket is None:
                    return nothing
                kinds += [output.type, socket.type]
                known, target, hands_on = len(kinds), socket, False
            link = self._link_to(socket)
        raise RecursionError

    def _given(self, own: Any, target: Any, kinds: list[str], output: Any, use: NodeUse) -> Source:
        """What an input receives from a node's output through sockets of these kinds."""
        inlined = compat.NODE_TREES_ARE_INLINED
        if output.type == "SHADER" and kinds[0 if inlined else -1] != "SHADER":  # no number can be made of a shader
            return Source(own if inlined else target, None, (own.type,) if inlined else tuple(reversed(kinds)))
        if output.type in unrolled.GONE and output.type != own.type:
            return Source(None, None, (own.type,))
        kinds = [*kinds, output.type]
        if inlined and len(set(kinds)) > 1 and not unrolled.is_computed(use):
            kinds = [own.type, output.type]
        return Source(output, use, tuple(reversed(kinds)))

    def _handed_on(self, output: Any) -> unrolled.Handed | None:
        """The input that a node hands on to an output, and what is entered to reach it; None for what has a value of its own."""
        node = self.node
        if node.bl_idname == "NodeGroupInput":
            groups = [index for index, entered in enumerate(self.entered) if not entered.is_zone]
            if not groups:
                return unrolled.NOTHING
            return same_item(self.entered[groups[-1]].node.inputs, output), self.entered[: groups[-1]]
        if not is_group(node):
            return unrolled.handed_on(self, output)
        if node.node_tree is not None and not _has_inside(node):
            self.note(_lacking(node.node_tree))
        ends = [n for n in _nodes_of(node) if n.bl_idname == "NodeGroupOutput" and n.is_active_output]
        return (same_item(ends[0].inputs, output), (*self.entered, Entered(node))) if ends else unrolled.NOTHING

    def _link_to(self, socket: Any) -> Any:
        """The link that feeds an input."""
        link = next(_links_to(socket), None)
        if link is None or link.is_valid or link.from_socket.type in unrolled.GONE:
            return link
        self.note("has nodes before it that are linked in a circle; such a link is left out, as in Cycles")
        return None

    def _zones_of(self, node: Any) -> Zones:
        tree, known = node.id_data, self.owner.context.zones
        key = self.owner.place, tree.as_pointer()
        if key not in known:
            known[key] = Zones(tree)
        return known[key]


def is_group(node: Any) -> bool:
    """Blender's own, or another add-on's; the Ward BSDF has an inside for other engines alone."""
    return hasattr(node, "node_tree") and node.bl_idname != "WardBSDFNode"


def output_use(tree: Any, name: str, owner: Owner) -> NodeUse | None:
    """The output node whose input `name` Cycles shows; None: nothing.

    Before Blender 5.0 the first one inside a group, if its input is linked, comes before the tree's own.
    """
    if not compat.NODE_TREES_ARE_INLINED:
        for groups in _group_paths(tree, ()):
            node = _nodes_output(groups[-1].node.node_tree)
            if node is not None and name in node.inputs and any(_links_to(node.inputs[name])):
                return NodeUse(node, groups, owner)
    node = _nodes_output(tree)
    return None if node is None else NodeUse(node, (), owner)


def _nodes_output(tree: Any) -> Any:
    # what Cycles would render: this node's name is that of a kind of output, not of an engine in use
    node = tree.get_output_node("CYCLES")
    return None if node is None or node.mute else node


def _group_paths(tree: Any, groups: tuple[Entered, ...]) -> Iterator[tuple[Entered, ...]]:
    """All groups in use, inner ones first, each with those around it."""
    for node in tree.nodes:
        if is_group(node) and not node.mute and _has_inside(node):
            inside = (*groups, Entered(node))
            yield from _group_paths(node.node_tree, inside)
            yield inside


def _has_inside(group: Any) -> bool:
    """Where the file that a group's tree is linked from lacks it, its place is held by a tree of no type, without nodes."""
    return group.node_tree is not None and group.node_tree.bl_idname == "ShaderNodeTree"


def _lacking(tree: Any) -> str:
    file = f" from '{tree.library.filepath}'" if tree.library else ""
    return f"needs the node group '{tree.name}'{file}, which is not there; it gives nothing, as in Cycles"


def _nodes_of(group: Any) -> Any:
    return group.node_tree.nodes if _has_inside(group) else ()


def _links_to(socket: Any) -> Iterator[Any]:
    """The links at an input; muted ones, and those from or to sockets that a node does not use now, do not count."""
    if socket.is_linked and socket.enabled:
        yield from (link for link in socket.links if not link.is_muted and link.from_socket.enabled)


def _handed_on(node: Any, output: Any) -> Any:
    """The input that a reroute, or a muted node, hands on to this output; None if it is neither, or there is no such input."""
    if node.bl_idname == "NodeReroute":
        return node.inputs[0]
    if node.mute:
        return next((link.from_socket for link in node.internal_links if link.to_socket == output), None)
    return None
