# SPDX-License-Identifier: GPL-3.0-or-later
"""The passes of a render: one table for the compositor's sockets and for the result."""

from __future__ import annotations

from collections.abc import Container
from typing import Any, NamedTuple


class Pass(NamedTuple):
    name: str
    channels: str
    type: str
    flag: str | None = None  # the view layer's setting with which Blender adds the pass by itself

    def added_by_blender(self, layer: Any) -> bool:
        return self.name == "Combined" or (self.flag is not None and getattr(layer, self.flag))


PASSES = (
    Pass("Combined", "RGBA", "COLOR", "use_pass_combined"),
    Pass("Depth", "Z", "VALUE", "use_pass_z"),
    Pass("Normal", "XYZ", "VECTOR", "use_pass_normal"),
    Pass("Albedo", "RGB", "COLOR"),
    Pass("Variance", "RGB", "COLOR"),
    Pass("Allocation Lobe", "X", "VALUE"),
    Pass("Allocation Cosine", "X", "VALUE"),
    Pass("Allocation Light", "X", "VALUE"),
)


def register_passes(engine: Any, scene: Any, layer: Any) -> None:
    """Gives the compositor a socket for each pass."""
    for p in PASSES:
        engine.register_pass(scene, layer, p.name, len(p.channels), p.channels, p.type)


def add_passes(engine: Any, layer: Any, made: Container[str]) -> None:
    """Makes room in the result, before it begins, for the passes out of `made` (names) that Blender does not add itself."""
    for p in PASSES:
        if p.name in made and not p.added_by_blender(layer):
            engine.add_pass(p.name, len(p.channels), p.channels, layer=layer.name)
