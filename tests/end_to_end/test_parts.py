# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of an image's samples, rendered apart and merged, are the image to the bit; what does not fit together is named."""

import itertools
import json
import shutil
import signal
import subprocess
from random import Random
from subprocess import PIPE

import exr
from command import BINARY, CommandTest, same

EVERYTHING = (
    "combined,depth,normal,albedo,variance,allocation,position,uv,object-index,material-index,emission,environment,"
    "diffuse-direct,diffuse-indirect=Diff Ind,diffuse-color,glossy-direct,glossy-indirect,glossy-color"
)


class Parts(CommandTest):
    scenes = ("teapot", "veach")

    def part(self, samples, *options, scene="veach", name=None):
        path = self.folder / (name or f"part {samples}.exr")
        self.render("--spp", "24", "--samples", samples, *options, scene=self.scene(scene), out=path)
        return path

    def parts(self, *ranges, options=(), scene="veach"):
        return [self.part(r, *options, "--threads", 1 + 2 * (i % 2), scene=scene) for i, r in enumerate(ranges)]

    def test_they_are_the_image_to_the_bit(self):
        whole, merged, stats = self.folder / "whole.exr", self.folder / "merged.exr", self.folder / "stats.json"
        for scene, allocation in itertools.product(self.scenes, ("equal", "auto", "second-moment")):
            with self.subTest(scene=scene, allocation=allocation):
                options = "--allocation", allocation, "--passes", EVERYTHING, "--layer", "Front"
                self.render("--spp", "24", *options, "--stats", stats, scene=self.scene(scene), out=whole)
                one = json.loads(stats.read_text())
                parts = self.parts("17..24", "0..3", "3..17", options=options, scene=scene)
                self.run_command("merge", *parts, "-o", merged, "--stats", stats)
                self.assertTrue(same(whole, merged))
                self.assertEqual(exr.read(whole).passes.keys(), exr.read(merged).passes.keys())
                self.assertEqual(exr.read(whole).attributes.keys(), exr.read(merged).attributes.keys())
                many = json.loads(stats.read_text())
                self.assertEqual(one.keys(), many.keys())
                differing = {"seconds", "cpu_seconds", "threads"}
                self.assertEqual({k for k in one if one[k] != many[k]} - differing, set())
                shares = [json.loads(exr.read(p).attributes["wardmis:seconds"])["render"] for p in parts]
                self.assertAlmostEqual(many["seconds"]["render"], sum(shares), places=6)

    def test_samplers(self):
        whole, merged = self.folder / "whole.exr", self.folder / "merged.exr"
        for sampler in ("stratified", "independent"):
            with self.subTest(sampler):
                self.render("--spp", "24", "--sampler", sampler, scene=self.scene("veach"), out=whole)
                self.run_command("merge", *self.parts("0..13", "13..24", options=["--sampler", sampler]), "-o", merged)
                self.assertTrue(same(whole, merged))

    def test_a_part_alone_is_an_image(self):
        part, merged = self.part("0..24"), self.folder / "merged.exr"
        self.run_command("merge", part, "-o", merged)
        first, second = exr.read(part).passes, exr.read(merged).passes
        self.assertLessEqual(second.keys(), first.keys())
        for name, pixels in second.items():
            self.assertTrue((pixels == first[name]).all(), name)

    def test_what_cannot_be_split(self):
        render = "render", self.scene(), "-o", self.out
        for options, says in (
            (("--samples", "0..8", "--time", "1"), "--time excludes --samples"),
            (("--samples", "0..8", "--cost", "measured"), "would measure other costs"),
            (("--samples", "8"), "no part of 64 samples"),
            (("--samples", "8..8"), "FROM < TO <= 64"),
            (("--samples", "-1..8"), "no part of 64 samples"),
            (("--samples", "0..65"), "no part of 64 samples"),
            (("--samples", "0..9", "--spp", "8"), "TO <= 8"),
        ):
            with self.subTest(options):
                self.refused(2, *render, *options, says=[says])

    def test_what_does_not_fit_together(self):
        first, rest = self.parts("0..8", "8..24")
        fits = {"scene": "veach"}
        for options, says in (
            ({"scene": "teapot"}, f"is of another scene than {first}"),
            ({**fits, "options": ["--seed", "2"]}, f"its settings/seed is 2, that of {first} is 0"),
            ({**fits, "options": ["--max-depth", "3"]}, f"its settings/max_depth is 3, that of {first} is 8"),
            ({**fits, "options": ["--resolution", "40x30"]}, "its"),
            ({**fits, "options": ["--layer", "Other"]}, 'its layer is "Other"'),
            ({**fits, "options": ["--passes", "combined,depth"]}, "its passes/2/channels is nothing"),
        ):
            with self.subTest(options):
                other = self.part("8..24", *options.get("options", ()), scene=options["scene"], name="other.exr")
                self.refused(2, "merge", first, other, "-o", self.out, says=[str(other), says, "--samples alone"])
        for parts, says in (
            ([first], "samples 8..24 are in none of the parts; render them with --samples 8..24"),
            ([rest], "samples 0..8 are in none"),
            ([first, rest, first], f"{first}: samples 0..8 are in {first}, too"),
            ([first, rest, self.part("20..24")], f"samples 20..24 are in {rest}, too"),
            ([first, self.part("10..24")], "samples 8..10 are in none"),
        ):
            with self.subTest(parts):
                self.refused(2, "merge", *parts, "-o", self.out, says=[says])
        self.assertFalse(self.out.exists())

    def test_files_that_are_no_parts(self):
        first, rest = self.parts("0..8", "8..24")
        plain, cut, gone = (self.folder / name for name in ("plain.exr", "cut.exr", "gone.exr"))
        self.render("--spp", "2", scene=self.scene("veach"), out=plain)
        cut.write_bytes(rest.read_bytes()[: rest.stat().st_size * 2 // 3])
        for path, says in ((plain, "is no part of an image"), (cut, "cannot be read"), (gone, "cannot be read")):
            with self.subTest(path):
                self.refused(4, "merge", first, path, "-o", self.out, says=[str(path), says])
        self.refused(2, "merge", first, rest, "-o", rest, says=["named by both PART and --output"])
        self.refused(2, "merge", first, rest, "-o", self.folder / "out.png", says=["ends in .exr"])
        self.refused(4, "merge", first, rest, "-o", self.folder / "none" / "out.exr", says=["folder does not exist"])
        self.assertFalse(self.out.exists())

    def test_no_bit_of_a_header_that_is_another_makes_another_image(self):
        first, rest = self.parts("0..8", "8..24")
        right, damaged = self.folder / "right.exr", self.folder / "damaged.exr"
        self.run_command("merge", first, rest, "-o", right)
        image = exr.read(right).passes
        whole = rest.read_bytes()
        random, found = Random(1), 0
        header = whole.index(b"wardmis:part_hash") + 64
        for _ in range(150):
            flipped = bytearray(whole)
            flipped[random.randrange(header)] ^= 1 << random.randrange(8)
            damaged.write_bytes(flipped)
            self.out.unlink(missing_ok=True)
            words = [BINARY, "merge", first, damaged, "-o", self.out]
            done = subprocess.run(words, capture_output=True, text=True, errors="replace", timeout=60, check=False)
            if done.returncode != 0:
                self.assertIn(done.returncode, (2, 4), done.stderr)
                self.assertIn(str(damaged), done.stderr)
                self.assertNotIn("json", done.stderr)
                found += 1
                continue
            for name, values in exr.read(self.out).passes.items():
                self.assertEqual(values.tobytes(), image[name].tobytes(), name)
        self.assertGreater(found, 100)

    def test_what_is_left_of_a_stopped_part_is_a_part(self):
        settings = "--spp", str(1 << 20), "--samples", f"4..{1 << 20}", "--allocation", "equal"
        words = "render", self.scene("veach"), "-o", self.folder / "long.exr", "--resolution", "48x32", *settings
        process = subprocess.Popen([BINARY, *words, "--progress", "json"], text=True, stdout=PIPE, stderr=PIPE)
        self.addCleanup(process.kill)
        for line in process.stdout:
            if json.loads(line).get("samples", 0) > 8:
                break
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        left = self.folder / "long.partial.exr"
        self.assertRegex(errors, rf"samples 4\.\.[0-9]+ are in {left}")
        done = json.loads(exr.read(left).attributes["wardmis:part"])["to"]
        self.assertGreater(done, 4)
        shutil.move(left, self.folder / "left.exr")
        self.refused(2, "merge", self.folder / "left.exr", "-o", self.out, says=["samples 0..4 are in none"])
