# SPDX-License-Identifier: GPL-3.0-or-later
"""The image depends on the seed and the settings, never on the threads; the specialised kernel gives the general one's image."""

import itertools

import numpy as np
from command import CommandTest, combined, same

ALLOCATIONS = ("equal", "variance", "second-moment", "albedo", "auto")
SAMPLERS = ("independent", "stratified", "sobol")


class Determinism(CommandTest):
    scenes = ("teapot", "veach")

    def image(self, name, *options):
        """Rendered with 16 samples: a pilot, and what it allocates."""
        path = self.folder / f"{len(list(self.folder.iterdir()))}.exr"
        few = () if "--samples-per-hit" in options else ("--samples-per-hit", "4")
        self.render("--spp", "16", *few, *map(str, options), scene=self.scene(name), out=path)
        return path

    def test_threads(self):
        for name, allocation, sampler in itertools.product(self.scenes, ALLOCATIONS, SAMPLERS):
            with self.subTest(scene=name, allocation=allocation, sampler=sampler):
                settings = "--allocation", allocation, "--sampler", sampler
                one, *more = (self.image(name, *settings, "--threads", threads) for threads in (1, 2, 7))
                for other in more:
                    self.assertTrue(same(one, other))

    def test_threads_with_other_settings(self):
        for settings in (
            ["--integrand", "joint"],
            ["--integrator", "direct"],
            ["--weights", "power"],
            ["--filter", "box"],
            ["--samples-per-hit", "21"],  # enough for the vectorised batch
        ):
            with self.subTest(settings):
                one, seven = (self.image("veach", *settings, "--threads", threads) for threads in (1, 7))
                self.assertTrue(same(one, seven))

    def test_seed(self):
        for name in self.scenes:
            first, second, again = (combined(self.image(name, "--seed", seed)) for seed in (1, 2, 1))
            np.testing.assert_array_equal(first, again)
            changed = (first != second).any(axis=2) & (first[..., :3].max(axis=2) > 0)
            self.assertGreater(changed.mean(), 0.4, name)
            self.assertLess(abs(first.mean() / second.mean() - 1), 0.1)

    def test_kernels(self):
        for name, integrator, allocation, samples in itertools.product(
            self.scenes, ("direct", "path"), ("equal", "second-moment"), ("4", "21")
        ):
            with self.subTest(scene=name, integrator=integrator, allocation=allocation, samples=samples):
                settings = "--integrator", integrator, "--allocation", allocation, "--samples-per-hit", samples
                auto, general = (
                    combined(self.image(name, *settings, "--kernel", kernel)) for kernel in ("auto", "general")
                )
                # they are compiled apart, but nothing is contracted or reordered
                np.testing.assert_array_equal(auto, general)
