# SPDX-License-Identifier: GPL-3.0-or-later
"""The demonstration's figures, table and sheet, on images whose error is known."""

import json
import tempfile
import unittest
from pathlib import Path

import exr
import metrics
import numpy as np
import OpenImageIO as oiio
import sheet
import table
from blender import clock_seconds


def flat(value: float, height: int = 20, width: int = 50) -> np.ndarray:
    return np.full((height, width, 4), value, np.float32)


class Metrics(unittest.TestCase):
    def test_rel_mse_of_a_known_error(self):
        self.assertAlmostEqual(metrics.rel_mse(flat(0.6), flat(0.5)), 0.1**2 / (0.5**2 + 0.01), places=6)
        self.assertEqual(metrics.rel_mse(flat(0.5), flat(0.5)), 0)

    def test_where_the_reference_is_black_the_error_counts(self):
        self.assertAlmostEqual(metrics.rel_mse(flat(0.1), flat(0.0)), 1.0, places=6)

    def test_the_trimmed_one_leaves_out_a_firefly_and_only_that(self):
        image = flat(0.6)
        image[3, 4, :3] = 1000.0
        self.assertGreater(metrics.rel_mse(image, flat(0.5)), 1000)
        self.assertAlmostEqual(
            metrics.rel_mse_trimmed(image, flat(0.5)), metrics.rel_mse(flat(0.6), flat(0.5)), places=6
        )

    def test_noise_of_the_reference_is_what_it_adds(self):
        random = np.random.default_rng(7)
        noisy = flat(0.5, 200, 200) + random.normal(0, 0.01, (200, 200, 4)).astype(np.float32)
        predicted = metrics.reference_noise(flat(0.5, 200, 200), flat(0.01**2, 200, 200))
        self.assertAlmostEqual(metrics.rel_mse(flat(0.5, 200, 200), noisy) / predicted, 1, delta=0.05)

    def test_other_sizes_are_refused(self):
        with self.assertRaisesRegex(ValueError, r"\(20, 50\).*\(10, 50\)"):
            metrics.rel_mse(flat(0.5), flat(0.5, height=10))

    def test_cycles_clock(self):
        self.assertEqual(clock_seconds("01:02.50"), 62.5)
        self.assertEqual(clock_seconds("1:00:00.25"), 3600.25)


class Exr(unittest.TestCase):
    def test_passes_attributes_and_orientation(self):
        spec = oiio.ImageSpec(3, 2, 5, oiio.FLOAT)
        spec.channelnames = ["L.Combined.R", "L.Combined.G", "L.Combined.B", "L.Combined.A", "L.Depth.Z"]
        spec.attribute("wardmis:seed", "7")
        pixels = np.arange(30, dtype=np.float32).reshape(2, 3, 5)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.exr"
            out = oiio.ImageOutput.create(str(path))
            out.open(str(path), spec)
            out.write_image(pixels)
            out.close()
            image = exr.read(path)
            with self.assertRaises(OSError):
                exr.read(Path(folder) / "missing.exr")
        np.testing.assert_array_equal(image.passes["Combined"], pixels[..., :4])
        np.testing.assert_array_equal(image.passes["Depth"], pixels[..., 4:])
        self.assertEqual(image.attributes["wardmis:seed"], "7")


class Table(unittest.TestCase):
    rows = [
        table.Row("teapot", "equal", 3.25, 0.5, 64, 1234567, 7654321, 0.0123, 0.01),
        table.Row("teapot", "Cycles", 4.0, None, 64, None, None, None, None),
    ]

    def test_markdown_has_every_figure_and_the_notes(self):
        text = table.markdown(self.rows, ["the formula"])
        lines = text.splitlines()
        self.assertEqual({line.count("|") for line in lines[:4]}, {len(table.HEADINGS) + 1})
        self.assertIn("1,234,567", lines[2])
        self.assertIn("0.01230", lines[2])
        self.assertIn("–", lines[3])
        self.assertIn("- the formula", lines)

    def test_terminal_columns_are_aligned(self):
        head, _, first, second, *_ = table.plain(self.rows, []).splitlines()
        self.assertEqual(head.index("seconds") + len("seconds"), first.index("3.25") + 4)
        self.assertEqual(first.index("equal"), second.index("Cycles"))

    def test_verdict_is_what_more_than_chance_speaks_for(self):
        def said(error, seconds):
            other = table.Row("teapot", "auto", seconds, 0.5, 64, 1, 1, 1, error)
            return table.verdict([self.rows[0], other, self.rows[1]])

        self.assertRegex(said(0.01 / 2, 3.25), "^teapot: use auto. Error times time, equal being 1: auto 0.50.$")
        self.assertRegex(
            said(0.01, 3.25 * 0.9), "^teapot: use equal. .*: auto 0.90; none is better by more than the 25% "
        )

    def test_verdict_is_of_allocations_alone(self):
        """Cycles has an error where it shows the same materials."""
        other = table.Row("studio", "auto", 3.25, 0.5, 64, 1, 1, 0.0123, 0.0123)
        cycles = table.Row("studio", "Cycles", 0.1, None, 64, None, None, 0.0001, 0.0001)
        said = table.verdict([self.rows[0], other, cycles])
        self.assertNotIn("Cycles", said)

    def test_json_keeps_full_precision(self):
        read = json.loads(table.as_json(self.rows, ["n"]))
        self.assertEqual(read["rows"][0]["rel_mse"], 0.0123)
        self.assertIsNone(read["rows"][1]["rel_mse"])
        self.assertEqual(read["notes"], ["n"])


class Sheet(unittest.TestCase):
    def test_srgb(self):
        self.assertEqual(sheet.displayed(flat(0.2140), 1).getpixel((0, 0)), (127, 127, 127))
        self.assertEqual(sheet.displayed(flat(9.0), 1).getpixel((0, 0)), (255, 255, 255))
        self.assertEqual(sheet.displayed(flat(float("nan")), 1).getpixel((0, 0)), (0, 0, 0))

    def test_exposure_brings_bright_scenes_into_range(self):
        self.assertEqual(sheet.exposure(flat(0.9)), 1)
        self.assertEqual(sheet.exposure(flat(9.0)), 1 / 16)
        self.assertEqual(sheet.exposure(flat(0.01)), 1)

    def test_error_colours_follow_the_scale(self):
        dark, bright = tuple(sheet.COLOURS[0].astype(int)), tuple(sheet.COLOURS[-1].astype(int))
        self.assertEqual(sheet.error_image(flat(0.5), flat(0.5)).getpixel((0, 0)), dark)
        self.assertEqual(sheet.error_image(flat(9.0), flat(0.5)).getpixel((0, 0)), bright)
        ten_percent = 0.5 + 0.1 * np.sqrt(0.5**2 + metrics.EPSILON)
        middle = tuple(sheet.COLOURS[4].astype(int))
        for found, wanted in zip(sheet.error_image(flat(ten_percent), flat(0.5)).getpixel((0, 0)), middle, strict=True):
            self.assertAlmostEqual(found, wanted, delta=1)

    def test_images_lie_above_their_errors(self):
        height, width = 120, 380
        green, red = (
            np.tile(np.float32([0, 1, 0, 1]), (height, width, 1)),
            np.tile(np.float32([1, 0, 0, 1]), (height, width, 1)),
        )
        columns = [sheet.Column("equal", red, ["a", "b"]) for _ in range(2)]
        made = np.asarray(
            sheet.contact_sheet("heading", sheet.Column("reference", green, ["a", "b"]), columns, ["note"])
        )
        self.assertEqual((made == (0, 255, 0)).all(axis=-1).sum(), height * width)
        images = (made == (255, 0, 0)).all(axis=-1)
        beside = np.arange(made.shape[1]) >= sheet.MARGIN + width  # the colour bar is under the reference
        errors = (made == sheet.COLOURS[-1]).all(axis=-1) & beside
        self.assertEqual((images.sum(), errors.sum()), (2 * height * width, 2 * height * width))
        self.assertGreater(np.nonzero(errors)[0].min(), np.nonzero(images)[0].max())


if __name__ == "__main__":
    unittest.main()
