# SPDX-License-Identifier: GPL-3.0-or-later
"""A node tree as Cycles sees it: without reroutes, muted nodes and the borders of groups."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from .. import compat
from .context import ExportContext

RAYS = ("camera", "diffuse", "glossy", "transmission")  # kinds of ray that may see different skies
LONGEST_CHAIN = 10_000  # of reroutes, muted nodes and borders of groups; a longer one is a circle


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
    """A node, and the group nodes that one enters to reach it: a group may be used several times, with other inputs."""

    node: Any
    groups: tuple[Any, ...]
    owner: Owner

    def note(self, text: str) -> None:
        label = self.node.bl_label
        self.owner.context.note(f"{self.owner.place}: node '{self.node.name}' ({label}) {text}")

    def has(self, name: str) -> bool:
        return name in self.node.inputs

    def source(self, key: str | int) -> Source:
        return self._follow(self.node.inputs[key])

    def is_linked(self, name: str) -> bool:
        """Whether another node feeds the input of this name, if there is one."""
        return self.has(name) and self.source(name).use is not None

    def _follow(self, socket: Any) -> Source:
        """From input to input against the links, through everything that only hands on.

        RecursionError where they go in a circle. Before Blender 5.0 each thing on the way converts to its own type and, if nothing is behind it, is 0; later ones are gone
        before anything is evaluated.
        """
        groups, target = self.groups, socket
        kinds: list[str] = [socket.type]  # from the last to the first
        hands_on = False  # whether `socket` belongs to a reroute or a muted node

        def converts(passed: Any) -> None:
            if not compat.NODE_TREES_ARE_INLINED:
                kinds.append(passed.type)

        def found(output: Any, use: NodeUse | None = None) -> Source:
            if output is not None:
                kinds.append(output.type)
            return Source(output, use, tuple(reversed(kinds)))

        for _ in range(LONGEST_CHAIN):
            link = self._link_to(socket)
            node: Any = link.from_node if link else None
            output: Any = link.from_socket if link else None
            through = _handed_on(node, output) if link else None
            if through is not None:
                converts(output)
                socket, hands_on = through, True
            elif node is None or node.mute:  # no way through a muted node: as if there were no link
                return found(target if compat.NODE_TREES_ARE_INLINED else None if hands_on else socket)
            elif node.bl_idname == "NodeGroupInput":
                if not groups:
                    return found(None)
                socket = target = _same(groups[-1].inputs, output)
                groups, hands_on = groups[:-1], False
                converts(socket)
            elif is_group(node):
                converts(output)
                if node.node_tree is not None and not _has_inside(node):
                    NodeUse(node, groups, self.owner).note(_lacking(node.node_tree))
                ends = [n for n in _nodes_of(node) if n.bl_idname == "NodeGroupOutput" and n.is_active_output]
                if not ends:
                    return found(None)
                socket = target = _same(ends[0].inputs, output)
                groups, hands_on = (*groups, node), False
            elif (chosen := NodeUse(node, groups, self.owner).handed_on(output)) is not None:
                (socket, groups), hands_on = chosen, False
                target = socket
            elif output.type == "SHADER" and kinds[-1] != "SHADER":  # no number can be made of a shader
                return found(target)
            else:
                return found(output, NodeUse(node, groups, self.owner))
        raise RecursionError

    def handed_on(self, output: Any) -> tuple[Any, tuple[Any, ...]] | None:
        """The input, and its groups, that a menu's switch or a bundle hands on to an output; both came with Blender 5."""
        if self.node.bl_idname == "GeometryNodeMenuSwitch" and output.identifier == "Output":
            chosen = self.chosen()
            found = next((s for s in self.node.inputs[1:] if s.name == chosen), None)
            return None if found is None else (found, self.groups)
        if self.node.bl_idname == "NodeSeparateBundle":
            bundle = self.source("Bundle").use
            if (
                bundle is not None
                and bundle.node.bl_idname == "NodeCombineBundle"
                and output.name in bundle.node.inputs
            ):
                return bundle.node.inputs[output.name], bundle.groups
        return None

    def chosen(self) -> str | None:
        """The item of a menu, if it is the same everywhere."""
        source = self.source("Menu")
        return source.socket.default_value if source.use is None and source.socket is not None else None

    def _link_to(self, socket: Any) -> Any:
        """The link that feeds an input."""
        link = _link_to(socket)
        if link is None or link.is_valid:
            return link
        self.note("has nodes before it that are linked in a circle; such a link is left out, as in Cycles")
        return None


def is_group(node: Any) -> bool:
    """Blender's own, or another add-on's; the Ward BSDF has an inside for other engines alone."""
    return hasattr(node, "node_tree") and node.bl_idname != "WardBSDFNode"


def output_use(tree: Any, name: str, owner: Owner) -> NodeUse | None:
    """The output node whose input `name` Cycles shows; None: nothing.

    Before Blender 5.0 the first one inside a group, if its input is linked, comes before the tree's own.
    """
    if not compat.NODE_TREES_ARE_INLINED:
        for groups in _group_paths(tree, ()):
            node = _nodes_output(groups[-1].node_tree)
            if node is not None and name in node.inputs and _link_to(node.inputs[name]) is not None:
                return NodeUse(node, groups, owner)
    node = _nodes_output(tree)
    return None if node is None else NodeUse(node, (), owner)


def _nodes_output(tree: Any) -> Any:
    # what Cycles would render: this node's name is that of a kind of output, not of an engine in use
    node = tree.get_output_node("CYCLES")
    return None if node is None or node.mute else node


def _group_paths(tree: Any, groups: tuple[Any, ...]) -> Iterator[tuple[Any, ...]]:
    """All groups in use, inner ones first, each with those around it."""
    for node in tree.nodes:
        if is_group(node) and not node.mute and _has_inside(node):
            yield from _group_paths(node.node_tree, (*groups, node))
            yield (*groups, node)


def _has_inside(group: Any) -> bool:
    """Where the file that a group's tree is linked from lacks it, its place is held by a tree of no type, without nodes."""
    return group.node_tree is not None and group.node_tree.bl_idname == "ShaderNodeTree"


def _lacking(tree: Any) -> str:
    file = f" from '{tree.library.filepath}'" if tree.library else ""
    return f"needs the node group '{tree.name}'{file}, which is not there; it gives nothing, as in Cycles"


def _nodes_of(group: Any) -> Any:
    return group.node_tree.nodes if _has_inside(group) else ()


def _link_to(socket: Any) -> Any:
    """The link at an input; muted ones, and those from or to sockets that a node does not use now, do not count."""
    if not socket.is_linked or not socket.enabled:
        return None
    return next((link for link in socket.links if not link.is_muted and link.from_socket.enabled), None)


def _handed_on(node: Any, output: Any) -> Any:
    """The input that a reroute, or a muted node, hands on to this output; None if it is neither, or there is no such input."""
    if node.bl_idname == "NodeReroute":
        return node.inputs[0]
    if node.mute:
        return next((link.from_socket for link in node.internal_links if link.to_socket == output), None)
    return None


def _same(sockets: Any, wanted: Any) -> Any:
    """The socket on the other side of a group's border."""
    return next(socket for socket in sockets if socket.identifier == wanted.identifier)
