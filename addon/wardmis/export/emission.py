# SPDX-License-Identifier: GPL-3.0-or-later
"""What the node trees of lights and worlds have in common: one emitting node with a colour and a strength."""

from __future__ import annotations

from typing import Any

from .context import ExportContext
from .model import Rgb

# what stands in for a colour that cannot be translated: never black, easy to see, and Blender's own sign for a missing image
MISSING: Rgb = (1.0, 0.0, 1.0)


def source(socket: Any) -> Any:
    """The socket that feeds `socket`, through reroutes; None if nothing does."""
    while socket.is_linked:
        link = socket.links[0]
        if link.is_muted:
            return None
        if link.from_node.bl_idname != "NodeReroute":
            return link.from_socket
        socket = link.from_node.inputs[0]
    return None


def surface(owner: Any, kind: str, context: ExportContext) -> Any:
    """The socket that feeds the output of the node tree of `owner`; None, and a note, if nothing does."""
    output = owner.node_tree.get_output_node("CYCLES")  # an output for all engines, or for Cycles, as Cycles would
    origin = source(output.inputs["Surface"]) if output else None
    if origin is None:
        context.note(f"{kind} '{owner.name}': no node is connected to its output; it gives no light")
    return origin


def note_unsupported(node: Any, owner: Any, kind: str, context: ExportContext, instead: str) -> None:
    context.note(f"{kind} '{owner.name}': node '{node.name}' ({node.bl_label}) is not supported; {instead}")


def strength(node: Any, owner: Any, kind: str, context: ExportContext) -> float:
    if source(node.inputs["Strength"]) is not None:
        context.note(f"{kind} '{owner.name}': the strength of node '{node.name}' must be a number; 1 is used instead")
        return 1.0
    return float(node.inputs["Strength"].default_value)


def constant_color(node: Any, owner: Any, kind: str, context: ExportContext) -> Rgb:
    origin = source(node.inputs["Color"])
    if origin is not None:
        note_unsupported(origin.node, owner, kind, context, "the colour is magenta instead")
        return MISSING
    r, g, b, _ = node.inputs["Color"].default_value
    return (r, g, b)
