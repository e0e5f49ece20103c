# SPDX-License-Identifier: GPL-3.0-or-later
"""The zones of a node tree, which Blender 5 has: which nodes are in which, and what one enters on the way to a node."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from .. import compat

# by the node that begins a zone, the one that ends it
ENDS = {"GeometryNodeRepeatInput": "GeometryNodeRepeatOutput", "NodeClosureInput": "NodeClosureOutput"}


@dataclass(frozen=True)
class Entered:
    """A group, by its node, or a zone, by the node that ends it.

    `iteration`: which one of a repeat zone. `caller`: of a closure zone, the use of the node that evaluates it.
    """

    node: Any
    iteration: int = 0
    caller: Any = None

    @property
    def place(self) -> tuple[Any, ...]:
        return (self.node.as_pointer(), self.iteration, self.caller and self.caller.place)

    @property
    def is_zone(self) -> bool:
        return self.node.bl_idname in ENDS.values()


class Zones:
    """Of one tree. What hangs on the node that begins a zone is in it, but for the node that ends it and what hangs on that."""

    def __init__(self, tree: Any) -> None:
        starts = [node for node in tree.nodes if node.bl_idname in ENDS and node.paired_output is not None]
        self._start = {start.paired_output.name: start for start in starts}
        # earlier Blenders have no zones, and leave out links that make a circle
        links = tree.links if compat.NODE_TREES_ARE_INLINED else ()
        links = [link for link in links if link.from_socket.enabled and link.to_socket.enabled]
        zones = [(start.name, end) for end, start in self._start.items()]
        next_ = _next(zones + [(x.from_node.name, x.to_node.name) for x in links if not x.is_muted])
        self._inside = {end: _reached(start, {**next_, end: set()}) - {end} for start, end in zones}
        # why Blender makes nothing at all of the tree
        self.fault = next(self._faults(tree, next_), "")
        if _has_circle(_next(zones + [(x.from_node.name, x.to_node.name) for x in links])):
            self.fault = "nodes are linked in a circle"

    def start(self, end: Any) -> Any:
        """The node that begins the zone; None: there is none."""
        return self._start.get(end.name)

    def left(self, entered: tuple[Entered, ...], node: Any) -> tuple[Entered, ...]:
        """What is still entered where a link leads back to this node."""
        while entered and entered[-1].is_zone and node.name not in self._inside[entered[-1].node.name]:
            entered = entered[:-1]
        return entered

    def _faults(self, tree: Any, next_: dict[str, set[str]]) -> Iterator[str]:
        for end, inside in self._inside.items():
            if inside & _reached(end, next_):
                yield f"the zone of node '{end}' is left by a link that does not lead through it"
        for a, b in combinations(self._inside, 2):
            shared = self._inside[a] & self._inside[b] - {self._start[a].name, self._start[b].name}
            if (a in self._inside[b]) == (b in self._inside[a]) and shared:
                yield f"the zones of the nodes '{a}' and '{b}' overlap"
        for node in tree.nodes:
            if not node.outputs and any(node.name in inside for inside in self._inside.values()):
                yield f"node '{node.name}' is in a zone"


def _next(links: list[tuple[str, str]]) -> dict[str, set[str]]:
    """To which nodes links lead from each."""
    next_: dict[str, set[str]] = {}
    for before, after in links:
        next_.setdefault(before, set()).add(after)
    return next_


def _has_circle(next_: dict[str, set[str]]) -> bool:
    links_to = Counter(after for found in next_.values() for after in found)
    pending = [node for node in next_ if node not in links_to]
    while pending:
        for after in next_.get(pending.pop(), ()):
            links_to[after] -= 1
            if links_to[after] == 0:
                pending.append(after)
    return any(links_to.values())


def _reached(first: str, next_: dict[str, set[str]]) -> set[str]:
    found, pending = {first}, [first]
    while pending:
        new = next_.get(pending.pop(), set()) - found
        found |= new
        pending += new
    return found


def same_item(sockets: Any, wanted: Any) -> Any:
    """The socket on the other side of a border."""
    return next(socket for socket in sockets if socket.identifier == wanted.identifier)
