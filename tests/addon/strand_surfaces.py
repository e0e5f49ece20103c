# SPDX-License-Identifier: GPL-3.0-or-later
"""The triangles that curves and spheres of an exported scene look like from a point, for test_shapes.py."""

from __future__ import annotations

import itertools

import numpy as np

STEPS = 6  # along a segment


def sides_of(radius: float) -> int:
    """Around a tube, so that they are less than half a millimetre inside it."""
    return max(8, int(np.ceil(np.pi / np.arccos(1 - min(0.5, 4e-4 / max(radius, 1e-9))))))


def surface_of(mesh, matrix: np.ndarray, eye: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) vertices in the world, (m, 3) triangles."""
    inside, points = np.linalg.inv(matrix) @ np.append(eye, 1), mesh.positions.astype(float)
    vertices, triangles = (
        _spheres(points, mesh.radii, mesh) if mesh.shape == "spheres" else _curves(points, mesh.radii, mesh, inside[:3])
    )
    return vertices @ matrix[:3, :3].T + matrix[:3, 3], triangles


def _spheres(points, radii, mesh):
    sides = sides_of(float(radii.max()))
    theta, phi = np.meshgrid(np.linspace(0, np.pi, sides // 2 + 1), np.linspace(0, 2 * np.pi, sides + 1), indexing="ij")
    unit = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    chosen = np.concatenate([p.triangles for p in mesh.primitives])
    return _grids(points[chosen][:, None, None] + radii[chosen][:, None, None, None] * unit)


def _curves(points, radii, mesh, eye):
    grids = []
    segments = np.concatenate([p.triangles for p in mesh.primitives]).astype(int)
    follows = {tuple(s) for s in segments.tolist()}
    keys = np.concatenate([points, radii[:, None]], axis=1)
    steps = np.linspace(0, 1, (mesh.pieces if mesh.shape == "ribbons" else 1 if mesh.shape == "cones" else STEPS) + 1)
    for a, b in segments.tolist():
        if mesh.shape == "cones":
            at, along = (
                keys[a] + (keys[b] - keys[a]) * steps[:, None],
                np.repeat((keys[b] - keys[a])[None], len(steps), 0),
            )
        else:
            p0 = keys[a - 1] if (a - 1, a) in follows else keys[a]
            p3 = keys[b + 1] if (b, b + 1) in follows else keys[b]
            at, along = _spline(p0, keys[a], keys[b], p3, steps[:, None])
        center, radius, tangent = at[:, :3], at[:, 3:], _unit(along[:, :3])
        across = _unit(np.cross(tangent, eye - center))
        if mesh.shape == "ribbons":
            grids.append(np.stack([center - across * radius, center + across * radius], axis=1))
            continue
        up, angle = (
            np.cross(across, tangent),
            np.linspace(0, 2 * np.pi, sides_of(float(radii.max())) + 1)[None, :, None],
        )
        grids.append(
            center[:, None] + radius[:, None] * (across[:, None] * np.cos(angle) + up[:, None] * np.sin(angle))
        )
    return _grids(np.stack(grids))


def _spline(p0, p1, p2, p3, u):
    at = 0.5 * (2 * p1 + (p2 - p0) * u + (2 * p0 - 5 * p1 + 4 * p2 - p3) * u**2 + (3 * p1 - p0 - 3 * p2 + p3) * u**3)
    along = 0.5 * ((p2 - p0) + 2 * (2 * p0 - 5 * p1 + 4 * p2 - p3) * u + 3 * (3 * p1 - p0 - 3 * p2 + p3) * u**2)
    return at, along


def _unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-30)


def _grids(grids):
    """(grids, rows, columns, 3) -> two triangles for each cell."""
    count, rows, columns = grids.shape[:3]
    cells = [r * columns + c for r, c in itertools.product(range(rows - 1), range(columns - 1))]
    corners = np.array([(i, i + 1, i + columns + 1, i, i + columns + 1, i + columns) for i in cells])
    triangles = corners.reshape(1, -1, 3) + (np.arange(count) * rows * columns)[:, None, None]
    return grids.reshape(-1, 3), triangles.reshape(-1, 3)
