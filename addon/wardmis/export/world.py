# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's world -> skies for kinds of ray: constant radiances, images of all directions, programs."""

from __future__ import annotations

import math
from typing import Any

from .. import compat
from .context import ExportContext
from .model import WorldData, not_finite
from .program.builder import Value
from .program.emission import Light, emission, image_of_directions
from .program.reader import Reader
from .socket_value import NotFinite
from .tree import RAYS, Owner, output_use


def export_worlds(world: Any, context: ExportContext) -> list[WorldData]:
    """As few skies as the rays see different ones; none where there is no light."""
    if world is None:
        return []
    place = f"world '{world.name}'"
    _note_settings(world, Owner("world", place, context))
    seen = {ray: _seen(world, Owner("world", place, context, ray)) for ray in RAYS}
    # as in Cycles, a sky that is one colour for all rays has no limit
    skies_of_camera = [_key(sky) for sky in seen["camera"]]
    limited = any(
        [_key(sky) for sky in skies] != skies_of_camera or not all(map(_is_one_color, skies)) for skies in seen.values()
    )
    limit = compat.max_bounces(world) if limited else WorldData.max_bounces
    skies: dict[Any, tuple[WorldData, set[str]]] = {}
    for ray in RAYS:
        for sky in seen[ray]:
            if compat.world_is_seen_by(world, ray) and any(sky.radiance):
                skies.setdefault(_key(sky), (sky, set()))[1].add(ray)
    for sky, rays in skies.values():
        sky.hidden_from = frozenset(RAYS) - rays
        sky.max_bounces = limit
    return [sky for sky, _ in skies.values()]


def _is_one_color(sky: WorldData) -> bool:
    return sky.texture is None and sky.program is None


def _key(sky: WorldData) -> Any:
    operations = repr(sky.program.operations) if sky.program else ""
    return (sky.radiance, sky.texture, sky.projection, sky.matrix.tobytes(), operations, sky.result, sky.cone)


@compat.deep_recursion()
def _seen(world: Any, owner: Owner) -> list[WorldData]:
    """What the owner's kind of ray sees."""
    try:
        skies = _translate(world, owner)
    except RecursionError:
        owner.context.note(
            f"{owner.place} has nodes that are linked in a circle, or in too long a chain; it gives no light"
        )
        return []
    except NotFinite:
        return []  # noted where it was found
    for sky in skies:
        wrong = not_finite(sky)
        if wrong is not None:
            owner.context.note(f"{owner.place}: its {wrong} is not a finite number; it gives no light")
            return []
    return skies


def _translate(world: Any, owner: Owner) -> list[WorldData]:
    if not compat.uses_nodes(world):
        return [WorldData(tuple(world.color))]
    output = output_use(world.node_tree, "Surface", owner)
    if output is None or output.source("Surface").is_nothing:
        owner.context.note(f"{owner.place}: no node is connected to its output; it gives no light")
        return []
    p = Reader("world")
    everything = emission(p, output)
    suns = _cones(p.suns)
    if not suns:
        return [_sky(p, everything, owner)]
    p.discs = False
    sky = emission(p, output)
    discs = p("vector-subtract", p.vector(everything), p.vector(sky))
    skies = [_sky(p, sky, owner)]
    for cone in suns:  # each is aimed at by itself
        skies.append(_sky(p, discs, owner))
        skies[-1].cone = cone
    return skies


def _cones(suns: list[tuple[Any, float]]) -> list[tuple[float, float, float, float]]:
    """Of discs of suns, each once; none where it is not known where they are, or they overlap."""
    if any(direction is None for direction, _ in suns):
        return []
    cones = sorted({(round(float(x), 7), round(float(y), 7), round(float(z), 7), size) for (x, y, z), size in suns})
    for i, (*a, size_a) in enumerate(cones):
        for *b, size_b in cones[:i]:
            if math.dist(a, b) < 0.51 * (size_a + size_b):
                return []
    return cones


def _sky(p: Reader, value: Value, owner: Owner) -> WorldData:
    light = Light(p, value, owner)
    if light.program is None:
        return WorldData(light.factor)
    image = image_of_directions(p, light.value)
    if image is not None:
        texture, projection, matrix = image
        return WorldData(light.factor, texture, matrix=matrix, projection=projection)
    return WorldData(light.factor, program=light.program, result=light.result)


def _note_settings(world: Any, owner: Owner) -> None:
    if not compat.uses_nodes(world):
        return
    output = output_use(world.node_tree, "Volume", owner)
    if output is not None and output.is_linked("Volume"):
        owner.context.note(f"{owner.place}: volumes are not supported; the air is clear")
