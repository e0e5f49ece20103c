# SPDX-License-Identifier: GPL-3.0-or-later
"""Tangents along UVs that triangles share, as Cycles has them: MikkTSpace (Mikkelsen 2008, "Simulation of wrinkled surfaces revisited").

Corners that have position, normal and UV in common, on triangles that are mapped the same way round, share one tangent: the
triangles' own, laid into the plane of the normal, in mean by the corners' angles."""

from __future__ import annotations

import numpy as np


def shared_tangents(
    positions: np.ndarray, normals: np.ndarray | None, uvs: np.ndarray, triangles: np.ndarray
) -> np.ndarray:
    """(n, 4) float32: a unit tangent and the bitangent's sign for each vertex.

    positions, normals (n, 3), None: flat; uvs (n, 2), v up; triangles (m, 3) of indices into these."""
    p, uv = positions.take(triangles, axis=0).astype(float), uvs.take(triangles, axis=0).astype(float)
    edges, steps = p[:, 1:] - p[:, :1], uv[:, 1:] - uv[:, :1]
    if normals is None:
        n = np.repeat(_unit(np.cross(edges[:, 0], edges[:, 1]))[:, None], 3, axis=1)
    else:
        n = normals.take(triangles, axis=0).astype(float)
    area = steps[:, 0, 0] * steps[:, 1, 1] - steps[:, 0, 1] * steps[:, 1, 0]
    own = edges[:, 0] * steps[:, 1, 1:] - edges[:, 1] * steps[:, 0, 1:]
    own *= np.where(area > 0, 1.0, -1.0)[:, None]

    before, after = np.roll(p, 1, axis=1) - p, np.roll(p, -1, axis=1) - p
    cosine = (_unit(_in_plane(before, n)) * _unit(_in_plane(after, n))).sum(axis=-1)
    weight = np.arccos(np.clip(cosine, -1, 1)) * ((area != 0) & np.isfinite(area))[:, None]
    parts = _unit(_in_plane(own[:, None], n)) * weight[..., None]

    # of triangles without an area in UVs a corner takes what others have there
    place = _classes(np.concatenate([p, n, uv], axis=-1).reshape(-1, 8).astype(np.float32))
    forward = np.repeat(area > 0, 3)
    sums = np.zeros((2, int(place.max(initial=-1)) + 1, 3))
    for way, mask in enumerate((~forward, forward)):
        for axis in range(3):
            sums[way, :, axis] = np.bincount(place[mask], parts.reshape(-1, 3)[mask, axis], minlength=sums.shape[1])
    side = np.where(np.repeat(area != 0, 3), forward, (sums[1, place] ** 2).sum(axis=-1) > 0)
    found = _unit(sums[side.astype(int), place])
    found[~found.any(axis=1)] = (1, 0, 0)

    tangents = np.tile(np.array([1, 0, 0, -1], np.float32), (len(positions), 1))
    tangents[triangles.reshape(-1)] = np.column_stack([found, np.where(side, 1.0, -1.0)])
    return tangents


def _unit(v: np.ndarray) -> np.ndarray:
    """0 for 0."""
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    return np.divide(v, length, out=np.zeros_like(v), where=length > 0)


def _in_plane(v: np.ndarray, n: np.ndarray) -> np.ndarray:
    return v - n * (v * n).sum(axis=-1, keepdims=True)


def _classes(rows: np.ndarray) -> np.ndarray:
    """The same number for equal rows of floats. By a hash of 64 bits: sorting whole rows takes ten times as long."""
    words = np.ascontiguousarray(rows + np.float32(0)).view(np.uint32).astype(np.uint64)  # + 0: -0 is 0
    keys = np.zeros(len(rows), np.uint64)
    for column in words.T:
        keys = (keys ^ column) * np.uint64(0x9E3779B97F4A7C15)
        keys ^= keys >> np.uint64(29)
    return np.unique(keys, return_inverse=True)[1].reshape(-1)
