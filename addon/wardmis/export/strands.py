# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair of particles, curves and point clouds -> points with radii, as Cycles makes them: splines through the points as they are,
ribbons or tubes as the scene says, spheres.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from .. import compat
from .attribute import (
    CENTER,
    DIAMETER,
    GENERATED,
    INTERCEPT,
    LENGTH,
    POINT_RANDOM,
    RADIUS,
    RANDOM,
    STRAND,
    TYPES,
    texture_space,
)
from .blender_pixels import decode_srgb
from .context import ExportContext, ExportError
from .hashing import random_numbers
from .mesh import Geometry, Wanted

MOST_PIECES = 16  # Embree's limit
SHAPES = {"RIBBONS": "ribbons", "THICK": "tubes", "THICK_LINEAR": "cones"}


def curve_settings(scene: Any) -> tuple[str, int]:
    """The scene's shape of curves and the pieces of a ribbon's segment; Cycles' defaults where that add-on is off."""
    settings = getattr(scene, "cycles_curves", None)
    return SHAPES[getattr(settings, "shape", "RIBBONS")], min(
        2 ** getattr(settings, "subdivisions", 2) + 1, MOST_PIECES
    )


def particle_hair(obj: Any) -> list[Any]:
    """The particle systems of an evaluated object whose strands a render shows."""
    systems = (m.particle_system for m in obj.modifiers if m.type == "PARTICLE_SYSTEM" and m.show_render)
    return [s for s in systems if s.settings.type == "HAIR" and s.settings.render_type == "PATH"]


def gather_hair(obj: Any, wanted: Wanted, settings: tuple[str, int], context: ExportContext) -> Geometry | None:
    """All strands of an object's particle systems, in its own space; their materials are slots of the object's."""
    points, radii, lengths, slots = [], [], [], []
    uvs: dict[str, list[Any]] = {name: [] for name in wanted.uv_sets}
    colors: dict[str, list[Any]] = {name: [] for name in wanted.attributes}
    to_object = np.array(obj.matrix_world.inverted_safe())
    for modifier in obj.modifiers:
        if modifier.type != "PARTICLE_SYSTEM" or modifier.particle_system not in particle_hair(obj):
            continue
        system = modifier.particle_system
        numbers = _rendered(system)
        if not numbers:
            continue
        keys = _keys(obj, system, numbers, context).reshape(-1, 3) @ to_object[:3, :3].T + to_object[:3, 3]
        keys = keys.reshape(len(numbers), -1, 3)
        points.append(keys.reshape(-1, 3).astype(np.float32))
        radii.append(_particle_radii(system.settings, keys).reshape(-1))
        lengths += [keys.shape[1]] * len(numbers)
        slots += [max(system.settings.material - 1, 0)] * len(numbers)
        for name, found in uvs.items():
            found.append(_roots(obj, system, modifier, numbers, keys.shape[1], name, "uv_on_emitter", "uv_layers"))
        for name, found in colors.items():
            found.append(
                _roots(obj, system, modifier, numbers, keys.shape[1], name, "mcol_on_emitter", "vertex_colors")
            )
    if not points:
        return None
    offsets = np.concatenate([[0], np.cumsum(lengths)])
    geometry = _curves(np.concatenate(points), np.concatenate(radii), offsets, settings, np.array(slots))
    _add_uvs(geometry, {name: np.concatenate(f) for name, f in uvs.items() if all(v is not None for v in f)})
    geometry.attributes |= {n: np.concatenate(f) for n, f in colors.items() if all(v is not None for v in f)}
    if wanted.generated:  # those of its root, all along a strand
        scale, offset = texture_space(obj.data)
        roots = geometry.positions[offsets[:-1]] * scale + offset
        geometry.attributes[GENERATED] = np.repeat(roots.astype(np.float32), lengths, axis=0)
    return _finished(geometry, offsets, wanted, "the hair", context)


def _rendered(system: Any) -> list[int]:
    """The numbers of the strands that are shown: the children's where there are any, else the parents'."""
    parents, children = len(system.particles), len(system.child_particles)
    shown = children if system.settings.child_type != "NONE" else 0
    return list(range(parents, parents + shown) if shown else range(parents))


def _keys(obj: Any, system: Any, numbers: list[int], context: ExportContext) -> np.ndarray:
    """(strands, steps, 3) in the world. A strand that has been cut ends before the last steps, and stays where it ends."""
    settings = system.settings
    steps = 2**settings.render_step + 1 + (settings.kink_extra_steps if settings.kink == "SPIRAL" else 0)
    out = np.empty((len(numbers), steps, 3))
    at = system.co_hair
    for row, number in zip(out, numbers):
        if number % 64 == 0:
            context.check_cancelled()
        row[:] = [at(object=obj, particle_no=number, step=step) for step in range(steps)]
    beyond = (out == 0).all(axis=-1)  # what co_hair gives for a step that is not there
    for step in range(1, steps):
        out[beyond[:, step], step] = out[beyond[:, step], step - 1]
    return out


def _particle_radii(settings: Any, keys: np.ndarray) -> np.ndarray:
    """(strands, steps): from root to tip, by how much of the strand's length is behind."""
    along = np.concatenate(
        [np.zeros((len(keys), 1)), np.cumsum(np.linalg.norm(np.diff(keys, axis=1), axis=2), axis=1)], axis=1
    )
    whole = along[:, -1:]
    left = 1 - np.divide(along, whole, out=np.zeros_like(along), where=whole > 0)
    shape = settings.shape
    if shape != 0:
        with np.errstate(divide="ignore"):
            left = left ** (1 + shape if shape < 0 else np.divide(1.0, 1.0 - shape))
    scale = 0.5 * settings.radius_scale
    radii = left * scale * (settings.root_radius - settings.tip_radius) + scale * settings.tip_radius
    if settings.use_close_tip:
        radii[:, -1] = 0
    return radii.astype(np.float32)


def _roots(
    obj: Any, system: Any, modifier: Any, numbers: list[int], steps: int, name: str, method: str, layers: str
) -> np.ndarray | None:
    """What the emitter's surface has where each strand grows; None where it has no layer of the name."""
    found = getattr(obj.data, layers, ())
    index = next((i for i, x in enumerate(found) if (x.name == name if name else x.active_render)), None)
    if index is None or not system.particles:
        return None
    read, parents = getattr(system, method), system.particles
    values = [
        tuple(read(modifier, parents[min(n, len(parents) - 1)], particle_no=n, **_layer(method, index)))
        for n in numbers
    ]
    out = np.array(values, np.float32)
    if method == "mcol_on_emitter":  # bytes, as an image has them
        out = decode_srgb(out)
    return np.repeat(out, steps, axis=0)


def _layer(method: str, index: int) -> dict[str, int]:
    return {"uv_no": index} if method == "uv_on_emitter" else {"vcol_no": index}


def gather_curves(curves: Any, wanted: Wanted, settings: tuple[str, int], context: ExportContext) -> Geometry | None:
    """Of data of the type Curves."""
    offsets = compat.curve_offsets(curves)
    positions = compat.point_values(curves, "position")
    if positions is None or not len(positions):
        return None
    if compat.curves_are_chains(curves):
        settings = "cones", settings[1]
    radii = compat.point_values(curves, "radius")
    if radii is None:
        radii = np.full(len(positions), compat.RADIUS_OF_CURVES, np.float32)
    geometry = _curves(positions, radii, offsets, settings, None)
    sizes = np.diff(offsets)
    uvs, values = None, {}
    for attribute in curves.attributes:
        if attribute.data_type not in TYPES or attribute.domain not in {"POINT", "CURVE"}:
            continue
        is_uv = uvs is None and attribute.data_type == "FLOAT2" and attribute.domain == "CURVE"
        if attribute.name not in wanted.attributes | wanted.uv_sets and not is_uv:
            continue
        of_points = compat.attribute_values(attribute, *TYPES[attribute.data_type])
        if attribute.domain == "CURVE":
            of_points = np.repeat(of_points, sizes, axis=0)
        values[attribute.name] = of_points
        uvs = of_points if is_uv else uvs  # the first one stands for all that ask for none by name
    geometry.attributes |= {name: values[name] for name in wanted.attributes & values.keys()}
    named = {name: values[name] for name in wanted.uv_sets & values.keys() if values[name].ndim == 2}
    _add_uvs(geometry, named | ({"": uvs} if "" in wanted.uv_sets and uvs is not None else {}))
    return _finished(geometry, offsets, wanted, f"curves '{curves.name}'", context)


def gather_points(cloud: Any, wanted: Wanted, context: ExportContext) -> Geometry | None:
    positions = compat.point_values(cloud, "position")
    if positions is None or not len(positions):
        return None
    radii = compat.point_values(cloud, "radius")
    if radii is None:
        radii = np.full(len(positions), compat.RADIUS_OF_POINTS, np.float32)
    geometry = Geometry(positions, None, None, np.arange(len(positions), dtype=np.uint32), None)
    geometry.radii, geometry.shape, geometry.inside = np.maximum(radii, 0), "spheres", compat.INSIDE_IS_SEEN
    for attribute in cloud.attributes:
        if attribute.name in wanted.attributes and attribute.data_type in TYPES:
            geometry.attributes[attribute.name] = compat.attribute_values(attribute, *TYPES[attribute.data_type])
    made: dict[str, Callable[[], np.ndarray]] = {
        CENTER: lambda: positions,
        RADIUS: lambda: geometry.radii,  # type: ignore[dict-item, return-value]
        POINT_RANDOM: lambda: random_numbers(len(positions)),
    }
    geometry.attributes |= {name: made[name]() for name in wanted.attributes & made.keys()}
    return _checked(geometry, f"point cloud '{cloud.name}'", context)


def _curves(
    positions: np.ndarray, radii: np.ndarray, offsets: np.ndarray, settings: tuple[str, int], slots: np.ndarray | None
) -> Geometry:
    sizes = np.diff(offsets)
    is_last = np.zeros(len(positions), bool)
    is_last[offsets[1:][sizes > 0] - 1] = True
    first = np.flatnonzero(~is_last).astype(np.uint32)
    segments = np.stack([first, first + 1], axis=1).astype(np.uint32)
    curve_of_point = np.repeat(np.arange(len(sizes)), sizes)
    geometry = Geometry(positions, None, None, segments, None if slots is None else slots[curve_of_point[first]])
    geometry.radii = np.maximum(radii, 0)
    geometry.shape, geometry.pieces = settings
    geometry.inside = geometry.shape != "ribbons" and compat.INSIDE_IS_SEEN
    return geometry


def _add_uvs(geometry: Geometry, sets: dict[str, np.ndarray]) -> None:
    geometry.uvs = sets.pop("", None)
    geometry.uv_sets = sets


def _finished(
    geometry: Geometry, offsets: np.ndarray, wanted: Wanted, what: str, context: ExportContext
) -> Geometry | None:
    """With what Curves Info tells, where it is read."""
    sizes = np.diff(offsets)
    steps = np.linalg.norm(np.diff(geometry.positions.astype(np.float64), axis=0), axis=1)
    behind = np.concatenate([[0], np.cumsum(steps)])
    starts = offsets[:-1][sizes > 0]
    along = behind - np.repeat(behind[starts], sizes[sizes > 0])
    whole = np.repeat(behind[offsets[1:][sizes > 0] - 1] - behind[starts], sizes[sizes > 0])
    count = len(geometry.positions)
    made: dict[str, Callable[[], Any]] = {
        STRAND: lambda: np.ones(count),
        INTERCEPT: lambda: np.divide(along, whole, out=np.zeros(count), where=whole > 0),
        LENGTH: lambda: whole,
        DIAMETER: lambda: 2 * geometry.radii,  # type: ignore[operator]
        RANDOM: lambda: np.repeat(random_numbers(len(sizes)), sizes),
    }
    for name in wanted.attributes & made.keys():
        geometry.attributes[name] = np.asarray(made[name](), np.float32)
    return _checked(geometry, what, context)


def _checked(geometry: Geometry, what: str, context: ExportContext) -> Geometry | None:
    assert geometry.radii is not None
    for values, of in ((geometry.positions, "place"), (geometry.radii, "radius")):
        wrong = np.flatnonzero(~np.isfinite(values).reshape(len(values), -1).all(axis=1))
        if len(wrong):
            raise ExportError(
                f"object '{context.owner}': the {of} of point {wrong[0]} of {what} is not finite; remove the point, or what makes it"
            )
    for values in _arrays(geometry):
        np.nan_to_num(values, copy=False, nan=0.0, posinf=0.0, neginf=0.0)
    return geometry if len(geometry.triangles) else None


def _arrays(geometry: Geometry) -> Iterable[np.ndarray]:
    own = [] if geometry.uvs is None else [geometry.uvs]
    return [*own, *geometry.uv_sets.values(), *geometry.attributes.values()]
