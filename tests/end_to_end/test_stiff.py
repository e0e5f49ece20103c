# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes blend/stiff-*.blend through the exported file and the command: every strategy (allocation, integrand, integrator)
renders them without dropping a sample, and gives the mean of each block of 16x16 pixels, and of the whole image, as its
reference does, within 4 standard errors.

The reference is `equal` with many samples at each hit. It is no judge of what all strategies do wrong: its direct light is
compared with plain.py, which shares nothing with the renderer, and its images of one court at three sizes with each other.

The standard error comes from seeds that are independent. Pixels share no random numbers, so that the spread over the seeds is
taken at each pixel and summed over the block, and follows Student's t with as many degrees of freedom as there are residuals e
that matter: (sum e^2)^2 / sum e^4, which is a third of their number for normal ones, and few where a few pixels hold all (an
edge of a lamp, a highlight that few samples meet). The quotient counts as the normal deviate of the same probability; where fewer
than TRUSTED degrees are left its spread means nothing, and the block is left out. At most LEFT_OUT of a scene's blocks may be.

There are 8 x 37 + 2 comparisons of 13 deviates. By chance one run in four has one beyond 4 (6.3e-5 each). So both sides are
rendered again with other seeds, and a block fails that deviates both times to the same side: 3874 x 6.3e-5 x 3.2e-5, one run in
128 000 by chance. The seeds are fixed, so that a run that failed fails again."""

import itertools
import json
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache

import numpy as np
import plain
from command import CommandTest, combined
from metrics import normal_deviate

SCENES = ("mirror", "grazing", "lights", "alphas", "mesh", "touching", "large", "small")
INTEGRATORS = ("direct", "path")
ALLOCATIONS = (
    *("equal", "variance", "standard-deviation", "second-moment", "inverse-variance", "equalised"),
    *("representativity", "albedo", "auto"),
)
STRATEGIES = list(itertools.product(ALLOCATIONS, ("split", "joint")))
SEEDS, SAMPLES = 3, 16
REFERENCE_SAMPLES, REFERENCE_PER_HIT = 64, 12
PLAIN_SAMPLES = 32
WIDTH, HEIGHT, BLOCK = 64, 48, 16
LIMIT, TRUSTED, LEFT_OUT = 4.0, 3.0, 0.1
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@dataclass
class Measured:
    """Of each block, and of the whole image: its mean, the variance of that, and the variance's degrees of freedom."""

    mean: np.ndarray
    variance: np.ndarray
    degrees: np.ndarray


def measure(images):
    """Of images that differ in their random numbers alone."""
    blocks = images.reshape(-1, HEIGHT // BLOCK, BLOCK, WIDTH // BLOCK, BLOCK).swapaxes(2, 3)
    blocks = blocks.reshape(len(images), -1, BLOCK * BLOCK)
    count, pixels = len(images), BLOCK * BLOCK
    residuals = blocks - blocks.mean(axis=0)
    squares, fourths = (residuals**2).sum(axis=(0, 2)), (residuals**4).sum(axis=(0, 2))
    mean = blocks.mean(axis=(0, 2))
    # the sum over blocks is one more block
    mean, squares, fourths = (np.append(a, f(a)) for a, f in ((mean, np.mean), (squares, np.sum), (fourths, np.sum)))
    pixels = np.append(np.full(len(mean) - 1, pixels), WIDTH * HEIGHT)
    return Measured(mean, squares / (count * (count - 1) * pixels**2), squares**2 / np.maximum(fourths, 1e-300))


def deviates(a, b):
    """Of a from b, as normal deviates; NaN where the spread cannot be trusted."""
    variance = a.variance + b.variance
    spread = sum(m.variance**2 / np.maximum(m.degrees, 1) for m in (a, b))
    degrees = np.maximum(variance**2 / np.maximum(spread, 1e-300), 1)  # Welch and Satterthwaite
    rounding = (1e-5 * b.mean) ** 2 + 1e-20  # what has no spread, as a background, may differ by it
    z = normal_deviate((a.mean - b.mean) / np.sqrt(variance + rounding), degrees)
    return np.where((degrees < TRUSTED) & (variance > rounding), np.nan, z)


class Stiff(CommandTest):
    scenes = tuple(f"stiff-{name}" for name in SCENES)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        pool = ThreadPoolExecutor(os.cpu_count())
        cls.addClassCleanup(pool.shutdown)
        cls.pool = pool

    def images(self, name, first_seed, samples, *options):
        """Luminance of SEEDS renders."""

        def image(seed):
            out = self.folder / f"{seed}-{'-'.join(options)}.exr"
            stats = out.with_suffix(".json")
            self.render(
                *("--seed", str(seed), "--spp", str(samples), "--stats", stats, "--resolution", f"{WIDTH}x{HEIGHT}"),
                *("--sampler", "independent", "--filter", "box", "--threads", "1", "--passes", "combined", *options),
                scene=self.scene(f"stiff-{name}"),
                out=out,
            )
            counts = json.loads(stats.read_text())["counts"]
            self.assertEqual(
                [counts[key] for key in ("nan", "infinite", "negative")], [0, 0, 0], "samples were dropped"
            )
            return combined(out)[..., :3].astype(float) @ LUMINANCE

        return np.stack(list(self.pool.map(image, range(first_seed, first_seed + SEEDS))))

    @cache  # noqa: B019
    def reference(self, name, integrator, attempt):
        return measure(
            self.images(
                *(name, 1000 + 100 * attempt, REFERENCE_SAMPLES, "--allocation", "equal", "--integrator", integrator),
                *("--samples-per-hit", str(REFERENCE_PER_HIT)),
            )
        )

    def compare(self, what, first, second):
        """Functions of the attempt, each of which gives what it measured."""
        z = deviates(first(0), second(0))
        beyond = np.abs(z) > LIMIT
        if beyond.any():
            again = deviates(first(1), second(1))
            beyond &= (np.abs(again) > LIMIT) & (z * again > 0)
            self.assertFalse(beyond.any(), f"{what}: deviates {z.round(1)}, and again {again.round(1)}")
        return z

    def strategies(self, name):
        z = []
        for integrator, (allocation, integrand) in itertools.product(INTEGRATORS, STRATEGIES):
            options = ("--integrator", integrator, "--allocation", allocation, "--integrand", integrand)
            z += [
                self.compare(
                    " ".join((name, *options)),
                    lambda attempt, options=options: measure(self.images(name, 100 * attempt, SAMPLES, *options)),
                    lambda attempt, integrator=integrator: self.reference(name, integrator, attempt),
                )
            ]
        return z

    def independent(self, name):
        scene = plain.Scene(self.scene(f"stiff-{name}"))
        return self.compare(
            f"{name}: direct light of equal against plain.py",
            lambda attempt: self.reference(name, "direct", attempt),
            lambda attempt: measure(scene.render(WIDTH, HEIGHT, PLAIN_SAMPLES, np.random.default_rng(attempt))),
        )

    def check(self, name):
        z = np.array([*self.strategies(name), self.independent(name)])
        self.assertLessEqual(np.isnan(z).mean(), LEFT_OUT, f"{name}: blocks without a spread to trust\n{z.round(1)}")

    def test_size_and_place_change_nothing(self):
        for name in ("large", "small"):
            self.compare(
                f"the court, {name}, against itself",
                lambda attempt, name=name: measure(self.images(name, 2000 + 100 * attempt, REFERENCE_SAMPLES)),
                lambda attempt: self.reference("touching", "path", attempt),
            )


for _name in SCENES:
    setattr(Stiff, f"test_{_name}", lambda self, name=_name: self.check(name))
