# SPDX-License-Identifier: GPL-3.0-or-later
"""What Simplify's settings of Cycles do to a render. Blender applies its own, the subdivisions and the child particles, itself."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Shrinking:
    """Of the images of nodes: both sides are halved so often, and further until none is longer than `limit`; 0: no limit."""

    halvings: int = 0
    limit: int = 0


FULL_SIZE = Shrinking()


def shrinking_of(scene: Any) -> Shrinking:
    cycles = getattr(scene, "cycles", None)
    if cycles is None or not scene.render.use_simplify:
        return FULL_SIZE
    share = getattr(cycles, "texture_resolution_render", 1.0)  # since Blender 5.2
    limit = cycles.texture_limit_render
    return Shrinking(-math.floor(math.log2(share)), 0 if limit == "OFF" else int(limit))


def not_simplified(depsgraph: Any) -> Iterator[str]:
    """What Cycles leaves out or approximates by these settings, and WardMIS does not."""
    scene = depsgraph.scene
    cycles = getattr(scene, "cycles", None)
    if cycles is None:
        return
    for kind in ("camera", "distance") if scene.render.use_simplify else ():
        culled = getattr(cycles, f"use_{kind}_cull") and (
            o.name for o in depsgraph.objects if getattr(o.original.cycles, f"use_{kind}_cull")
        )
        if culled and (name := next(culled, "")):
            yield f"Simplify's {kind.title()} Culling is not supported: object '{name}' is rendered wherever it is, as all are"
    if cycles.use_fast_gi:
        yield "Fast GI Approximation is not supported: indirect light is rendered in full"
