# SPDX-License-Identifier: GPL-3.0-or-later
"""`wardmis eval`: the golden file's points in every precision, bad lines, and life in a pipe."""

import itertools
import json
import math
import os
import resource
import struct
import subprocess
import time
from collections import defaultdict

from blender import ROOT
from command import BINARY, CommandTest, close

GOLDEN = json.loads((ROOT / "tests" / "golden" / "golden.json").read_text())
BRDFS = {"ward": "ward", "ward-dur": "ward_dur", "ward-gmd": "ward_gmd"}  # and the golden file's keys
FLOAT = 5.4e8  # roundings of float in roundings of double
NORMAL = 0, 0, 1, 0, 0, 1  # wi and wo, a line of numbers


def text(*lines):
    return "".join(" ".join(map(repr, line)) + "\n" for line in lines)


def smallest(value, e, lost):
    """What a value may lose where exp(-e), which loses so much, is below the normal numbers."""
    return lost * max(1, math.exp(min(700, math.log(value) + e))) if value > 0 else 0


class Eval(CommandTest):
    scenes = ()

    def eval(self, lines, *options, code=0):
        done = subprocess.run(
            [BINARY, "eval", *map(str, options)], input=lines, capture_output=True, text=True, timeout=60
        )
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def values(self, lines, *options):
        return [[float(x) for x in line.split()] for line in self.eval(text(*lines), *options).stdout.splitlines()]

    def one(self, line, *options):
        (values,) = self.values([line], *options)
        return values


class GoldenPoints(Eval):
    def points(self, precision):
        """(BRDF's key, point, printed values) of all points that the precision can hold."""
        groups = defaultdict(list)
        for point in GOLDEN["brdf_points"]:
            if precision != "float" or point["float32_representable"]:
                groups[point["alpha_x"], point["alpha_y"]].append(point)
        for ((ax, ay), points), (brdf, key) in itertools.product(groups.items(), BRDFS.items()):
            lines = [point["wi"] + point["wo"] for point in points]
            options = "--brdf", brdf, "--alpha-x", repr(ax), "--alpha-y", repr(ay), "--precision", precision
            printed = self.values(lines, *options)
            self.assertEqual(len(printed), len(points))
            for point, values in zip(points, printed, strict=True):
                yield key, point, values

    def check(self, precision, factor, lost):
        checked = 0
        for key, point, (f, pdf, log_pdf, weight) in self.points(precision):
            expect = point["expect"]
            with self.subTest(key=key, point=point):
                checked += 1
                if "E" not in expect:
                    self.assertEqual((f, pdf, log_pdf, weight), (0, 0, -math.inf, 0))
                    continue
                tolerance = factor * expect["suggested_reltol_double"]
                for value, name in ((f, key), (pdf, "pdf")):
                    log = expect[f"ln_{name}"]
                    exact = expect[name] or (math.exp(log) if log > -750 else 0)  # the file has no denormals
                    slack = smallest(exact, expect["E"], lost)
                    self.assertAlmostEqual(value, exact, delta=tolerance * exact + slack, msg=name)
                self.assertAlmostEqual(
                    log_pdf, expect["ln_pdf"], delta=tolerance * max(1, abs(expect["ln_pdf"])), msg="ln pdf"
                )
                exact = expect[f"weight_{key}"]
                self.assertAlmostEqual(weight, exact, delta=tolerance * exact, msg="weight")
                # and so the logarithm of f, where f itself underflows
                log = expect[f"ln_{key}"]
                self.assertAlmostEqual(
                    log_pdf + math.log(weight / point["wi"][2]), log, delta=2 * tolerance * max(1, abs(log)), msg="ln f"
                )
        return checked

    def test_double(self):
        self.assertEqual(self.check("double", 1, 2e-323), 3 * len(GOLDEN["brdf_points"]))

    def test_float(self):
        self.assertGreaterEqual(self.check("float", FLOAT, 1.2e-38), 3 * 40)  # 0 in place of denormals

    def test_long_double(self):
        """No rounding but that of 17 digits, where the input is not amplified: a hundredth of a double's tolerance."""
        self.assertEqual(self.check("longdouble", 1, 2e-323), 3 * len(GOLDEN["brdf_points"]))
        for key, point, values in self.points("longdouble"):
            expect = point["expect"]
            if "E" not in expect:
                continue
            tolerance = max(2.3e-16, 0.01 * expect["suggested_reltol_double"])
            for value, name in zip(values, (key, "pdf", "ln_pdf", f"weight_{key}"), strict=True):
                if abs(expect[name]) > 0:
                    size = max(1, abs(expect[name])) if name == "ln_pdf" else abs(expect[name])
                    self.assertAlmostEqual(value, expect[name], delta=tolerance * size, msg=f"{name} {point}")


class GoldenSampling(Eval):
    def test_double(self):
        self.check("double", 2.0**-52, 60)

    def test_float(self):
        self.check("float", 2.0**-23, 30)

    def test_long_double(self):
        self.check("longdouble", 2.0**-52, 60)

    def check(self, precision, epsilon, least):
        above = below = 0
        for case, (brdf, key) in itertools.product(GOLDEN["walter_sampling"], BRDFS.items()):
            expect, ax, ay = case["expect"], case["alpha_x"], case["alpha_y"]
            # the file takes e^-E = u1, the command 1 - u1
            line = [1 - case["u1"], case["u2"], *case["wo"]]
            options = "--sample", "--brdf", brdf, "--alpha-x", repr(ax), "--alpha-y", repr(ay)
            x, y, z, f, pdf, log_pdf, weight = self.one(line, *options, "--precision", precision)
            with self.subTest(brdf=brdf, case=case):
                # 1 - u1 is rounded: what that changes in the slopes' length, and some roundings of the direction
                e = -math.log(case["u1"])
                step = epsilon * (8 + 1 / (case["u1"] * max(e, 1e-9)))
                if step > 1e-2 * math.sqrt(e + 1e-9):
                    continue  # float knows no such u1
                for value, exact in zip((x, y, z), expect["wi"], strict=True):
                    self.assertAlmostEqual(value, exact, delta=step)
                if abs(expect["wi"][2]) > step:
                    self.assertEqual(z <= 0, expect["below"])
                if z <= 0:
                    below += 1
                    self.assertEqual((f, pdf, log_pdf, weight), (0, 0, -math.inf, 0))
                    continue
                above += 1
                # a step of the direction in units of the lobe's width
                hz = z + case["wo"][2]
                slopes = math.hypot(1, (x + case["wo"][0]) / hz, (y + case["wo"][1]) / hz)
                steps = 6 / hz + 1 / z + 4 * (math.sqrt(e) + 1e-3) * slopes / (hz * min(ax, ay))
                tolerance = 500 * epsilon + step * steps
                if tolerance > 0.1:
                    continue  # alpha 1e-6 and float directions: docs/theory.md
                for value, name in ((pdf, "pdf"), (weight, f"weight_{key}")):
                    self.assertAlmostEqual(value, expect[name], delta=tolerance * expect[name], msg=name)
                self.assertAlmostEqual(log_pdf, math.log(expect["pdf"]), delta=2 * tolerance + 100 * epsilon)
                self.assertAlmostEqual(f * z / pdf, weight, delta=40 * epsilon * weight)
                # what is printed for the sample is what is printed for its direction
                if precision == "double" and brdf == "ward":
                    again = self.one([x, y, z, *case["wo"]], *options[1:])
                    self.assertEqual(again, [f, pdf, log_pdf, weight])
        self.assertGreater(above, least)
        self.assertGreater(below, 0)


class Numbers(Eval):
    def test_lafortune_phong(self):
        """(m + 2)/(2 pi) cos(gamma)^m, at two angles from the mirror direction; the logarithm where the density underflows."""
        for gamma, m in ((0.0, 10.0), (0.3, 10.0), (0.3, 0.0), (1.2, 800.0), (1.57, 1e6)):
            line = (0.0, math.sin(gamma), math.cos(gamma), 0.0, 0.0, 1.0)
            f, pdf, log_pdf, weight = self.one(line, "--brdf", "lafortune-phong", "--m", m)
            lobe = math.cos(gamma) ** m / (2 * math.pi)
            self.assertAlmostEqual(f, (m + 2) * lobe, delta=1e-11 * f)
            self.assertAlmostEqual(pdf, (m + 1) * lobe, delta=1e-11 * pdf)
            exact = math.log((m + 1) / (2 * math.pi)) + m * math.log(math.cos(gamma))
            self.assertAlmostEqual(log_pdf, exact, delta=1e-12 * max(1, abs(exact)))
            self.assertAlmostEqual(weight, (m + 2) / (m + 1) * math.cos(gamma), delta=1e-14)
        line = (0.8, 0.0, 0.6, 0.8, 0.0, 0.6)  # cos(gamma) = -0.28: behind the lobe
        self.assertEqual(self.one(line, "--brdf", "lafortune-phong"), [0, 0, -math.inf, 0])
        x, y, z, *values = self.one((0.3, 0.7, 0.6, 0.0, 0.8), "--brdf", "lafortune-phong", "--sample")
        self.assertAlmostEqual(-0.6 * x + 0.8 * z, 0.7 ** (1 / 11), delta=1e-14)
        self.assertEqual(self.one((x, y, z, 0.6, 0.0, 0.8), "--brdf", "lafortune-phong"), values)

    def test_albedo_factors(self):
        line = 0.6, 0.0, 0.8, -0.5, 0.1, math.sqrt(1 - 0.26)
        f, pdf, log_pdf, weight = self.one(line, "--alpha", 0.2)
        both = self.one(line, "--alpha", 0.2, "--rho-s", 0.5, "--rho-d", 0.3)
        diffuse = 0.3 / math.pi
        for value, exact in zip(
            both, (0.5 * f + diffuse, pdf, log_pdf, 0.5 * weight + diffuse * 0.8 / pdf), strict=True
        ):
            self.assertAlmostEqual(value, exact, delta=1e-14 * abs(exact))

    def test_isotropic(self):
        line = 0.6, 0.0, 0.8, -0.5, 0.1, 0.8
        self.assertEqual(
            self.one(line, "--brdf", "ward-gmd", "--alpha", 0.3),
            self.one(line, "--brdf", "ward-gmd", "--alpha-x", 0.3, "--alpha-y", 0.3),
        )

    def test_underflow(self):
        """Far from the lobe, the density is 0, its logarithm and the weight are not."""
        line = 0.8, 0.0, 0.6, 0.8, 0.0, 0.6
        e = (0.8 / 0.6 / 1e-3) ** 2
        for precision in ("float", "double", "longdouble"):
            f, pdf, log_pdf, weight = self.one(line, "--alpha", 1e-3, "--precision", precision)
            self.assertEqual((f, pdf), (0, 0))
            self.assertAlmostEqual(log_pdf, math.log(1e6 / (2 * math.pi) * 4 / 1.2**3) - e, delta=e * 1e-5)
            self.assertAlmostEqual(weight, 1.2**3 / (2 * 4), delta=1e-6)

    def test_grazing_float(self):
        """Retro-reflection at 1e-30: the half vector's square is no float."""
        for brdf, exact in (("ward", 1e-30), ("ward-dur", 1), ("ward-gmd", 1)):
            line = 1.0, 0.0, 1e-30, -1.0, 0.0, 1e-30
            _, pdf, log_pdf, weight = self.one(line, "--brdf", brdf, "--precision", "float")
            self.assertAlmostEqual(weight, exact, delta=1e-6 * exact)
            self.assertAlmostEqual(log_pdf, math.log(pdf), delta=1e-4)

    def test_f_at_cosines_that_are_hardly_numbers(self):
        """f_s is an ordinary number where f_s cos is a denormal one, or none."""
        wo, inverse = (0.0, 0.0, 1.0), math.exp(-1) / math.pi  # h = (1, 0, 1): E = 1 for alpha = 1
        for precision, cosines in (("float", (3e-45, 1e-43, 1e-30)), ("double", (5e-324, 1e-320, 1e-200))):
            for cosine, (brdf, exact) in itertools.product(
                cosines,
                (
                    ("ward", lambda c: inverse / 4 / math.sqrt(c)),
                    ("ward-dur", lambda c: inverse / 4 / c if c > 1e-300 else math.inf),
                    ("ward-gmd", lambda _: 2 * inverse),
                ),
            ):
                with self.subTest(precision=precision, cosine=cosine, brdf=brdf):
                    if precision == "float":
                        cosine = struct.unpack("f", struct.pack("f", cosine))[0]
                    f, *_ = self.one((1.0, 0.0, cosine, *wo), "--brdf", brdf, "--alpha", 1, "--precision", precision)
                    expected = exact(cosine)
                    if expected > (3.4e38 if precision == "float" else 1.7e308):
                        self.assertEqual(f, math.inf)
                    else:
                        self.assertAlmostEqual(f / expected, 1, delta=1e-6)

    def test_signed_numbers(self):
        self.assertEqual(self.eval("+0.6 0 +8e-1 0 -0.0 1\n").stdout, self.eval("0.6 0 0.8 0 0 1\n").stdout)
        for word in ("++1", "+-1", "+", "-+1"):
            self.assertIn(f"'{word}'", self.eval(f"0.6 0 0.8 0 0 {word}\n", code=2).stderr)

    def test_numbers_next_to_one(self):
        for precision in ("float", "double", "longdouble"):
            last = 1 - 2.0**-53
            values = self.one((last, last, 0.6, 0.0, 0.8), "--sample", "--precision", precision)
            self.assertTrue(all(math.isfinite(v) for v in values[:3]))
            self.assertAlmostEqual(math.hypot(*values[:3]), 1, delta=1e-6)

    def test_json(self):
        line = 0.6, 0.0, 0.8, -0.5, 0.1, 0.8
        (found,) = map(json.loads, self.eval(text(line), "--json").stdout.splitlines())
        self.assertEqual([found[k] for k in ("f", "pdf", "log_pdf", "weight")], self.one(line))
        self.assertEqual(len(found), 4)
        (below,) = map(json.loads, self.eval(text((0.6, 0.0, -0.8, 0.0, 0.0, 1.0)), "--json").stdout.splitlines())
        self.assertEqual(below, {"f": 0, "pdf": 0, "log_pdf": None, "weight": 0})
        line = 0.3, 0.7, 0.6, 0.0, 0.8
        (found,) = map(json.loads, self.eval(text(line), "--json", "--sample").stdout.splitlines())
        self.assertEqual([*found["wi"], *list(found.values())[1:]], self.one(line, "--sample"))


class Lines(Eval):
    def test_bad_lines_are_named(self):
        good = text(NORMAL)
        for bad, says in (
            ("0 0 1 0 0", "5 numbers"),
            ("0 0 1 0 0 1 0", "7 numbers"),
            ("0 0 1 0 0 one", "'one'"),
            ("0 0 1 0 0 1,", "'1,'"),
            ("0 0 nan 0 0 1", "'nan'"),
            ("0 0 inf 0 0 1", "'inf'"),
            ("0 0 1e999 0 0 1", "'1e999'"),
            ("0 0 1e308 0 0 1e308", "overflows"),
            ("\0é", "'???'"),
            ("0" * 100000, "characters"),
        ):
            for end in ("", "\n", "\n" + good):
                with self.subTest(bad=bad[:20], end=end):
                    done = self.eval(good + "# a comment\n\n" + good + bad + end, code=2)
                    self.assertRegex(done.stderr, r"\Awardmis: error: line 5: [^\n]+\n\Z")
                    self.assertIn(says, done.stderr)
                    self.assertEqual(len(done.stdout.splitlines()), 2)
        for u in ("1 0", "0 1", "-0.1 0", "0 2"):
            self.assertIn("line 1: u", self.eval(f"{u} 0 0 1\n", "--sample", code=2).stderr)
        self.assertIn("line 1", self.eval("0 0 1 0 0 1e300", "--precision", "float", code=2).stderr)

    def test_blanks_and_comments(self):
        lines = "# wi wo\n\n  \t\n 0 0 1\t0 0 1  # straight\r\n#\n0 0 1 0 0 1"
        self.assertEqual(len(self.eval(lines).stdout.splitlines()), 2)
        self.assertEqual(self.eval("").stdout, "")

    def test_17_digits(self):
        (line,) = self.eval(text((0.1, 0.2, 0.9, 0.3, 0.1, 0.9))).stdout.splitlines()
        for word in line.split():
            self.assertEqual(word, f"{float(word):.17g}")

    def test_usage(self):
        for options, says in (
            (("--brdf", "phong"), "lafortune-phong"),
            (("--alpha", "0"), "--alpha"),
            (("--alpha", "0.1", "--alpha-x", "0.1", "--alpha-y", "0.1"), "--alpha"),
            (("--alpha-x", "0.1"), "--alpha-y"),
            (("--m", "3"), "--m"),
            (("--brdf", "lafortune-phong", "--alpha", "0.1"), "--alpha"),
            (("--precision", "half"), "longdouble"),
            (("--rho-d", "-1"), "--rho-d"),
            *(((option, "nan"), option) for option in ("--alpha", "--m", "--rho-s", "--rho-d")),
            (("--alpha-x", "nan", "--alpha-y", "0.1"), "--alpha-x"),
        ):
            with self.subTest(options=options):
                self.refused(2, "eval", *options, says=[says])

    def test_file(self):
        file = self.folder / "lines.txt"
        file.write_text(text(NORMAL) * 3)
        self.assertEqual(self.run_command("eval", file).stdout, self.eval(text(NORMAL) * 3).stdout)
        self.refused(4, "eval", self.folder / "none.txt", says=["none.txt"])
        self.refused(4, "eval", self.folder, says=["read"])


class Pipe(Eval):
    def test_long_stream(self):
        """Lines that meet the ends of reads in every way, and a speed that millions of them want."""
        count = 200_000
        lines = [(0.0, (i % 997) / 1000, 0.9, 0.1, 0.0, 1.0) for i in range(count)]
        began = time.monotonic()
        printed = self.eval(given := text(*lines)).stdout.splitlines()
        self.assertLess(time.monotonic() - began, 5)
        self.assertEqual(len(printed), count)
        self.assertEqual(printed, (printed[:997] * (count // 997 + 1))[:count])
        self.assertGreater(len(set(printed)), 900)
        self.assertEqual(len(given.splitlines()), count)

    def test_answers_before_the_end(self):
        """A program may write a line and wait for its answer."""
        pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
        process = subprocess.Popen([BINARY, "eval"], text=True, bufsize=1, **pipes)
        self.addCleanup(close, process)
        first = self.eval(text(NORMAL)).stdout
        for _ in range(3):
            process.stdin.write(text(NORMAL))
            process.stdin.flush()
            self.assertEqual(process.stdout.readline(), first)
        process.stdin.close()
        self.assertEqual(process.wait(10), 0)

    def test_listener_that_has_gone(self):
        read, write = os.pipe()
        os.close(read)
        try:
            done = subprocess.run(
                [BINARY, "eval"],
                input=text(NORMAL) * 100000,
                text=True,
                stdout=write,
                stderr=subprocess.PIPE,
                timeout=20,
            )
        finally:
            os.close(write)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_disk_that_is_full(self):
        file = self.folder / "out.txt"
        with file.open("w") as out:
            done = subprocess.run(
                [BINARY, "eval"], input=text(NORMAL) * 1000, text=True, stdout=out, stderr=subprocess.PIPE, timeout=20,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)),
            )  # fmt: skip
        self.assertEqual(done.returncode, 4)
        self.assertRegex(done.stderr, r"\Awardmis: error: [^\n]*free space\n\Z")
