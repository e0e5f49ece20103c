# SPDX-License-Identifier: GPL-3.0-or-later
"""A material's node tree as its shader sees it: without reroutes, muted nodes and the borders of groups."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .context import ExportContext

MUTED: Any = object()  # what feeds a socket through a muted link, or a muted node without a way through


@dataclass(frozen=True)
class NodeUse:
    """A node, and the group nodes that one enters to reach it: a group may be used several times, with other inputs."""

    node: Any
    groups: tuple[Any, ...]
    material: str
    context: ExportContext

    def note(self, text: str) -> None:
        label = self.node.bl_label
        self.context.note(f"{place(self.material, self.context)}: node '{self.node.name}' ({label}) {text}")

    def has(self, name: str) -> bool:
        return name in self.node.inputs

    def origin(self, key: str | int) -> tuple[Any, NodeUse | None]:
        """What feeds an input: (output socket, its node), or (the unconnected input whose own value holds, None)."""
        return self._follow(self.node.inputs[key])

    def _follow(self, socket: Any) -> tuple[Any, NodeUse | None]:
        groups = self.groups
        while socket.is_linked and not socket.links[0].is_muted:
            node, output = socket.links[0].from_node, socket.links[0].from_socket
            if node.bl_idname == "NodeReroute":
                socket = node.inputs[0]
            elif node.bl_idname == "NodeGroupInput" and groups:
                socket = _same(groups[-1].inputs, output)
                groups = groups[:-1]
            elif node.mute:
                through = [link.from_socket for link in node.internal_links if link.to_socket == output]
                if not through:
                    return MUTED, None
                socket = through[0]
            elif node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None:
                ends = [n for n in node.node_tree.nodes if n.bl_idname == "NodeGroupOutput" and n.is_active_output]
                if not ends:
                    return MUTED, None
                socket = _same(ends[0].inputs, output)
                groups = (*groups, node)
            else:
                return output, NodeUse(node, groups, self.material, self.context)
        return socket, None


def place(material: str, context: ExportContext) -> str:
    """Where a note is about."""
    return f"material '{material}' on object '{context.owner}'"


def _same(sockets: Any, wanted: Any) -> Any:
    """The socket on the other side of a group's border."""
    return next(socket for socket in sockets if socket.identifier == wanted.identifier)
