# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals as Cycles rounds them since 5.2."""

from __future__ import annotations

import unittest

import numpy as np
from wardmis.export.octahedral import rounded


class Rounded(unittest.TestCase):
    def test_is_near_of_unit_length_and_rounds_no_more(self):
        vectors = np.random.default_rng(1).normal(size=(2000, 3))
        vectors[:6] = [sign * axis for axis in np.eye(3) for sign in (1, -1)]
        vectors = (vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype(np.float32)
        found = rounded(vectors)
        self.assertEqual(found.dtype, np.float32)
        off = np.abs(found - vectors).max(axis=1)
        self.assertLess(off.max(), 5e-5)
        self.assertGreater(np.median(off), 3e-6)
        np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1, atol=1e-6)
        np.testing.assert_allclose(rounded(found), found, atol=2e-7)

    def test_by_hand(self):
        # (.6, 0, .8) is 3/7 and 0 on the octahedron: 46810.7 and 32768 of 65535 parts, rounded 46811 and 32768
        x, y = 46811 * 2 / 65535 - 1, 32768 * 2 / 65535 - 1
        expected = np.array([x, y, 1 - x - y])
        np.testing.assert_allclose(
            rounded(np.array([[0.6, 0, 0.8]], np.float32))[0], expected / np.linalg.norm(expected), atol=1e-7
        )
        # below, the corners are folded out: (0, 0, -1) is one of them
        np.testing.assert_allclose(rounded(np.array([[0, 0, -1]], np.float32))[0], [0, 0, -1], atol=4e-5)
