# SPDX-License-Identifier: GPL-3.0-or-later
"""The passes of a render, as docs/command.md names them.

A registered pass gets a socket in the compositor and its place in the result, where the channels of the image's file find it by name.
Blender logs each one that a file lacks: Combined alone is in a preview, and a technique that the scene cannot use has no map.
"""

from __future__ import annotations

from typing import Any

PASSES = (
    ("Combined", "RGBA", "COLOR"),
    ("Depth", "Z", "VALUE"),
    ("Normal", "XYZ", "VECTOR"),
    ("Albedo", "RGB", "COLOR"),
    ("Variance", "RGB", "COLOR"),
    ("Allocation Lobe", "X", "VALUE"),
    ("Allocation Cosine", "X", "VALUE"),
    ("Allocation Light", "X", "VALUE"),
)


def register_passes(engine: Any, scene: Any, layer: Any) -> None:
    for name, channels, kind in PASSES:
        engine.register_pass(scene, layer, name, len(channels), channels, kind)
