# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes -> vertex arrays, without welding: what costs least of what shows the same.

All flat: positions alone. All smooth, no UVs: positions and normals per vertex. Else one vertex for each face corner.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import compat
from .context import ExportContext, ExportError
from .model import MeshData, PrimitiveData


@dataclass
class Geometry:
    """The vertex arrays of a mesh, and the material slot of each triangle (None: slot 0 for all)."""

    positions: np.ndarray
    normals: np.ndarray | None
    uvs: np.ndarray | None
    triangles: np.ndarray
    slots: np.ndarray | None


def gather_geometry(mesh: Any, with_uvs: bool, context: ExportContext) -> Geometry | None:
    """None for a mesh without faces."""
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
    uvs = compat.uvs(mesh) if with_uvs else None
    vertex_of_corner = compat.corner_vertices(mesh)
    context.check_cancelled()
    if shading == "CORNER" or uvs is not None:
        # take() is three times as fast as an index in brackets
        geometry = Geometry(positions.take(vertex_of_corner, axis=0), None, uvs, corners, slots)
        context.check_cancelled()
        if shading == "CORNER":
            geometry.normals = compat.corner_normals(mesh)
        elif shading == "POINT":
            geometry.normals = compat.vertex_normals(mesh).take(vertex_of_corner, axis=0)
    else:
        geometry = Geometry(positions, None, None, vertex_of_corner.view(np.uint32)[corners], slots)
        if shading == "POINT":
            geometry.normals = compat.vertex_normals(mesh)
    context.check_cancelled()
    _check_directions(geometry, mesh, context)
    return geometry


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
    return MeshData(name, geometry.positions, geometry.normals, geometry.uvs, primitives)


def transformed(mesh: MeshData, linear: np.ndarray) -> MeshData:
    """The mesh in the shape that a 3x3 matrix without an inverse gives it: a flat one, with the normals of its faces."""
    positions = (mesh.positions.astype(np.float64) @ linear.T).astype(np.float32)
    return MeshData(mesh.name, positions, None, mesh.uvs, mesh.primitives)
