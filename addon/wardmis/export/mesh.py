# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes -> vertex arrays, without welding: what costs least of what shows the same.

All flat: positions alone. All smooth, no UVs: positions and normals per vertex. Else one vertex for each face corner.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .. import compat
from . import octahedral
from .attribute import CENTER, GENERATED, RADIUS, generated, read_attribute
from .context import ExportContext, ExportError
from .model import MaterialData, MeshData, PrimitiveData
from .tangent import shared_tangents


@dataclass
class Geometry:
    """The vertex arrays of a mesh, and the material slot of each triangle (None: slot 0 for all).

    Of curves and point clouds, which have radii, `triangles` are those of MeshData.
    """

    positions: np.ndarray
    normals: np.ndarray | None
    uvs: np.ndarray | None
    triangles: np.ndarray
    slots: np.ndarray | None
    uv_sets: dict[str, np.ndarray] = field(default_factory=dict)
    attributes: dict[str, np.ndarray] = field(default_factory=dict)
    tangents: dict[str, np.ndarray] = field(default_factory=dict)
    generated: tuple[float, ...] | None = None
    radii: np.ndarray | None = None
    shape: str = ""
    pieces: int = 5
    inside: bool = False


@dataclass(frozen=True)
class Wanted:
    """What materials read of a mesh besides its shape."""

    uv_sets: frozenset[str] = frozenset()  # "": the one that is active for rendering
    attributes: frozenset[str] = frozenset()
    tangents: frozenset[str] = frozenset()  # UV sets
    generated: bool = False


def wanted_of(materials: Iterable[MaterialData]) -> Wanted:
    materials = list(materials)
    programs = [m.program for m in materials if m.program is not None]
    return Wanted(
        frozenset().union(*(m.uv_sets for m in materials)),
        frozenset().union(*(p.attributes for p in programs)),
        frozenset().union(*(p.tangents for p in programs)),
        any(p.reads("generated", "tangent") for p in programs),
    )


def gather_geometry(mesh: Any, wanted: Wanted, context: ExportContext, obj: Any = None) -> Geometry | None:
    """None for a mesh without faces. `obj`: that has it, for the names of vertex groups."""
    if not mesh.polygons:
        return None
    corners = compat.triangle_corners(mesh)
    context.check_cancelled()
    positions = compat.positions(mesh)
    if not np.isfinite(positions).all():
        vertex = int(np.flatnonzero(~np.isfinite(positions).all(axis=1))[0])
        raise ExportError(
            f"object '{context.owner}': vertex {vertex} of mesh '{mesh.name}' is at {tuple(positions[vertex].tolist())}, "
            "which is not finite; remove the vertex, or the modifier that makes it"
        )
    context.check_cancelled()
    slots = _triangle_slots(mesh)
    shading = compat.shading(mesh)
    uv_sets = {name: uvs for name in sorted(wanted.uv_sets) if (uvs := compat.uvs(mesh, name)) is not None}
    attributes = {
        name: found for name in sorted(wanted.attributes) if (found := read_attribute(mesh, name, obj)) is not None
    }
    by_corner = bool(uv_sets) or any(a.by_corner for a in attributes.values())
    vertex_of_corner = compat.corner_vertices(mesh)
    context.check_cancelled()
    if shading == "CORNER" or by_corner:
        # take() is three times as fast as an index in brackets
        geometry = Geometry(positions.take(vertex_of_corner, axis=0), None, uv_sets.get(""), corners, slots)
        context.check_cancelled()
        if shading == "CORNER":
            geometry.normals = compat.corner_normals(mesh)
        elif shading == "POINT":
            geometry.normals = compat.vertex_normals(mesh).take(vertex_of_corner, axis=0)
    else:
        geometry = Geometry(positions, None, None, vertex_of_corner.view(np.uint32)[corners], slots)
        if shading == "POINT":
            geometry.normals = compat.vertex_normals(mesh)
    if geometry.normals is not None and compat.NORMALS_HAVE_32_BITS:
        geometry.normals = octahedral.rounded(geometry.normals)
    context.check_cancelled()
    corner_of = vertex_of_corner if shading == "CORNER" or by_corner else None
    geometry.uv_sets = {name: uvs for name, uvs in uv_sets.items() if name}
    geometry.attributes = {
        name: a.values if corner_of is None or a.by_corner else a.values.take(corner_of, axis=0)
        for name, a in attributes.items()
    }
    if wanted.generated:
        geometry.generated, undeformed = generated(mesh, positions)
        if undeformed is not None:
            geometry.attributes[GENERATED] = undeformed if corner_of is None else undeformed.take(corner_of, axis=0)
    _check_directions(geometry, mesh, context)
    context.check_cancelled()
    for name in sorted(wanted.tangents):
        uvs = uv_sets.get(name)
        if uvs is not None and np.isfinite(uvs).all():
            geometry.tangents[name] = shared_tangents(geometry.positions, geometry.normals, uvs, corners)
    return geometry


def has_bent_normals(geometry: Geometry) -> bool:
    """Whether a normal is so far from a face's own that Cycles' rules for it show: at 11 degrees, those of a sphere of
    16 segments, nothing does, at 22 2 % of a block."""
    if geometry.normals is None or geometry.radii is not None:
        return False
    at = geometry.triangles
    a, b, c = (geometry.positions.take(at[:, k], axis=0) for k in range(3))
    faces = np.cross(b - a, c - a)
    size = np.linalg.norm(faces, axis=1)
    for k in range(3):
        normals = geometry.normals.take(at[:, k], axis=0)
        if (
            np.einsum("ij,ij->i", normals, faces) < np.cos(np.radians(15)) * np.linalg.norm(normals, axis=1) * size
        ).any():
            return True
    return False


def _triangle_slots(mesh: Any) -> np.ndarray | None:
    face_slots = compat.face_material_indices(mesh)
    if face_slots is None or not face_slots.any():
        return None
    return face_slots[compat.triangle_faces(mesh)]


def _check_directions(geometry: Geometry, mesh: Any, context: ExportContext) -> None:
    """Leaves normals and UVs out, with a note, where they are not finite: the shape can still be shown."""
    for what, instead in (("normals", "it is shown flat"), ("uvs", "it is shown without them")):
        values = getattr(geometry, what)
        if values is not None and not np.isfinite(values).all():
            context.note(f"object '{context.owner}': some {what} of mesh '{mesh.name}' are not finite; {instead}")
            setattr(geometry, what, None)


def assemble(name: str, geometry: Geometry, materials: tuple[int, ...]) -> MeshData:
    """The mesh with a material for each slot. An index beyond the slots means the last slot, as in Blender."""
    if geometry.slots is None:
        primitives = [PrimitiveData(materials[0], geometry.triangles)]
    else:
        slots = np.clip(geometry.slots, 0, len(materials) - 1)
        used = np.flatnonzero(np.bincount(slots))
        primitives = [PrimitiveData(materials[slot], geometry.triangles[slots == slot]) for slot in used]
    return MeshData(
        name,
        geometry.positions,
        geometry.normals,
        geometry.uvs,
        primitives,
        geometry.uv_sets,
        geometry.attributes,
        geometry.tangents,
        generated=geometry.generated,
        radii=geometry.radii,
        shape=geometry.shape,
        pieces=geometry.pieces,
        inside=geometry.inside,
    )


def transformed(mesh: MeshData, linear: np.ndarray) -> MeshData:
    """The mesh in the shape that a 3x3 matrix gives it, with the normals of its faces; of spheres the places, and their sizes alike."""
    positions = (mesh.positions.astype(np.float64) @ linear.T).astype(np.float32)
    if mesh.radii is None:
        return replace(mesh, positions=positions, normals=None, tangents={})
    radii = (mesh.radii * np.cbrt(abs(np.linalg.det(linear)))).astype(np.float32)
    told = {name: values for name, values in ((CENTER, positions), (RADIUS, radii)) if name in mesh.attributes}
    return replace(mesh, positions=positions, radii=radii, attributes=mesh.attributes | told)
