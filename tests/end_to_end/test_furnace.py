# SPDX-License-Identifier: GPL-3.0-or-later
"""blend/furnace.blend through Blender: two spheres under a sky of radiance 1 show their albedo, to 0.1 %."""

import json
import tempfile
import unittest
from pathlib import Path

import blender
import numpy as np
from blender import ROOT

PIXEL = 5 / 512  # the orthographic camera's width over the image's
TOLERANCE = 1e-3


class Furnace(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            settings = {
                "wardmis.samples": 128,
                "wardmis.sampler": "independent",
                "wardmis.seed": 1,
                "view_layers.ViewLayer.wardmis.use_pass_variance": True,
            }
            done = blender.render(ROOT / "blend" / "furnace.blend", Path(folder) / "furnace.exr", settings)
        cls.image = done.exr.passes["Combined"][..., :3]
        cls.variance = done.exr.passes["Variance"]
        rows, columns = np.indices(cls.image.shape[:2])
        cls.height, cls.right = (127.5 - rows) * PIXEL, (columns - 255.5) * PIXEL

    def distance(self, center):
        """Of each pixel from a sphere's centre: the sine of the angle at which it is seen."""
        return np.hypot(self.right - center, self.height)

    def test_sky(self):
        away = (self.distance(-1.25) > 1.05) & (self.distance(1.25) > 1.05)
        np.testing.assert_allclose(self.image[away], 1, rtol=1e-5)

    def test_diffuse_sphere(self):
        inside = self.image[self.distance(1.25) < 0.95]
        self.assertLess(abs(inside.mean() / 0.5 - 1), 1e-5)
        np.testing.assert_allclose(inside, 0.5, rtol=TOLERANCE)

    def test_ward_sphere(self):
        """Rings about angles of the golden file, in which the albedo changes little."""
        golden = json.loads((ROOT / "tests" / "golden" / "golden.json").read_text())["albedo"]
        albedos = {a["theta_o_deg"]: a["ward-gmd"] for a in golden if a["alpha_x"] == a["alpha_y"] == 0.1}
        for theta, width in ((0, 10), (45, 4), (70, 3)):
            low, high = np.sin(np.radians([max(0, theta - width), theta + width]))
            ring = (self.distance(-1.25) >= low) & (self.distance(-1.25) < high)
            error = np.sqrt(self.variance[ring].sum(axis=0)) / ring.sum()
            self.assertLess(error.max(), TOLERANCE / 4)
            ratio = self.image[ring].mean(axis=0) / (0.3 + 0.5 * albedos[theta])
            np.testing.assert_allclose(ratio, 1, atol=TOLERANCE, err_msg=f"{theta} degrees")
