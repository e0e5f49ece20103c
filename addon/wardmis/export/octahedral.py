# SPDX-License-Identifier: GPL-3.0-or-later
"""Unit vectors in 32 bits: two numbers of 16 bits on the unfolded faces of an octahedron (Cigolle et al. 2014)."""

from __future__ import annotations

import numpy as np

_HALF = np.float32(65535 / 2)


def rounded(vectors: np.ndarray) -> np.ndarray:
    """(n, 3) float32: what is left of unit vectors, each within 5e-5."""
    sums = np.abs(vectors).sum(axis=1, keepdims=True) + np.float32(1e-6)
    flat = vectors[:, :2] / sums
    flat = np.where(vectors[:, 2:] >= 0, flat, (1 - np.abs(flat[:, ::-1])) * np.copysign(np.float32(1), flat))
    flat = np.floor(np.clip(flat * _HALF + (_HALF + np.float32(0.5)), 0, 65535)) / _HALF - 1
    z = 1 - np.abs(flat).sum(axis=1, keepdims=True)
    flat += np.copysign(np.maximum(-z, 0), -flat)
    found = np.concatenate([flat, z], axis=1)
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True), np.float32)
