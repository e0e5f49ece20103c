# SPDX-License-Identifier: GPL-3.0-or-later
"""What a render wanted its user to know: kept for a panel, and told once each where there is none.

The panel shows what the last render of each view layer has said. It is no data of the file: it must neither be undone nor saved.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import bpy

from . import layout


@dataclass(frozen=True)
class Warning_:
    text: str
    owner: str = ""  # the object that it is about, where there is one

    @property
    def full(self) -> str:
        """With the owner's name."""
        return self.text if not self.owner or f"'{self.owner}'" in self.text else f"object '{self.owner}': {self.text}"

    @property
    def short(self) -> str:
        """For a place where the owner's name stands already."""
        quoted = re.escape(f"object '{self.owner}'")
        return re.sub(rf"^{quoted}: | (on|of) {quoted}", "", self.text) if self.owner else self.text


_warnings: dict[tuple[str, str], dict[str, Warning_]] = {}  # by scene and view layer, then by text
last_failure = ""  # what the last render that failed has said
_told: set[str] = set()  # in the background, where an animation would say them for every frame


def begin(scene: str, layer: str) -> None:
    """A render begins anew."""
    _warnings[scene, layer] = {}


def add(scene: str, layer: str, text: str, owner: str = "") -> None:
    """A note of the export knows whose it is. In the background it is told at once."""
    known = _warnings.setdefault((scene, layer), {})
    if text not in known:
        known[str(text)] = Warning_(str(text), owner or _owner_of(text))
        if bpy.app.background:
            _tell(known[text].full)


def _owner_of(text: str) -> str:
    named = [name for name in re.findall(r"(?:object|camera) '(.+?)'(?=\W|$)", text) if name in bpy.data.objects]
    return named[0] if named else str(getattr(text, "owner", ""))


def of_scene(scene: Any) -> list[Warning_]:
    """Of the last renders of its view layers."""
    found: dict[str, Warning_] = {}
    for layer in scene.view_layers:
        found |= _warnings.get((scene.name, layer.name), {})
    return list(found.values())


def events(scene: str, layer: str) -> Iterator[dict[str, str]]:
    """For another Blender, which take() them."""
    for warning in _warnings.get((scene, layer), {}).values():
        yield {"event": "warning", "message": warning.text, "owner": warning.owner}


def take(event: dict[str, Any], scene: str, layer: str) -> None:
    """Adds it if it is one."""
    if event.get("event") == "warning":
        add(scene, layer, str(event.get("message")), str(event.get("owner", "")))
        redraw()


def failed(text: str) -> None:
    global last_failure
    last_failure = text


def count(scene: str, layer: str) -> int:
    return len(_warnings.get((scene, layer), ()))


def by_owner(warnings: Iterable[Warning_]) -> dict[str, list[Warning_]]:
    groups: dict[str, list[Warning_]] = {}
    for warning in warnings:
        groups.setdefault(warning.owner, []).append(warning)
    return groups


def count_text(count: int) -> str:
    return f"{count} warning{'s' if count != 1 else ''}"


def _tell(text: str) -> None:
    """A line of its own, once, and not among Blender's, which go to standard output."""
    if text not in _told:
        _told.add(text)
        print(f"WardMIS: warning: {text}", file=sys.stderr, flush=True)


def redraw() -> None:
    """Soon, and by Blender's main thread: renders are another."""
    if not bpy.app.background:
        bpy.app.timers.register(layout.redraw, first_interval=0.0)


@bpy.app.handlers.persistent
def _on_load(*_: Any) -> None:
    _warnings.clear()


@bpy.app.handlers.persistent
def _on_end(*_: Any) -> None:
    """Of a render, or of an animation."""
    if bpy.app.background and _told:
        print(f"WardMIS: {count_text(len(_told))}, named above", file=sys.stderr, flush=True)
        _told.clear()


_HANDLERS = (
    (bpy.app.handlers.load_pre, _on_load),
    (bpy.app.handlers.render_complete, _on_end),
    (bpy.app.handlers.render_cancel, _on_end),
)


def register() -> None:
    for handlers, handler in _HANDLERS:
        handlers.append(handler)


def unregister() -> None:
    _warnings.clear()
    for handlers, handler in _HANDLERS:
        handlers.remove(handler)
