# SPDX-License-Identifier: GPL-3.0-or-later
"""wardmis study: its JSON against the golden file, its other outputs, its mistakes."""

import csv
import json
import math
import os
import re
import stat
from pathlib import Path

from blender import ROOT
from command import CommandTest

GOLDEN = json.loads((ROOT / "tests" / "golden" / "golden.json").read_text())


def options(case):
    """The command line of a golden case."""
    names = {"alpha": "alpha", "alpha_x": "alpha-x", "alpha_y": "alpha-y", "phi_o_deg": "phi-o", "m": "m"}
    names |= {"theta_o_deg": "theta-o", "rho_s": "rho-s", "rho_d": "rho-d", "R": "R", "model": "brdf", "mode": "mode"}
    words = [word for key, name in names.items() if key in case for word in (f"--{name}", case[key])]
    if case.get("joint"):
        words += ["--integrand", "joint"]
    if "techniques" in case:
        words += ["--techniques", "lobe,cosine,uniform"]
    return words


class Study(CommandTest):
    scenes = ()

    def study(self, *arguments, **more):
        return json.loads(self.run_command("study", "--json", *arguments, **more).stdout)

    def test_json_has_the_golden_file_s_keys_and_values(self):
        """A case of every kind; tests/native/study has all of them."""
        seen = set()
        for case in GOLDEN["estimator_cases"] + GOLDEN["three_technique_cases"]:
            given = case["input"]
            kind = (given["model"], given["mode"], given.get("joint"), "alpha_x" in given, "techniques" in given)
            if kind in seen:
                continue
            seen.add(kind)
            result = self.study("--trials", "0", *options(given))
            with self.subTest(given):
                self.assertEqual(set(result) - {"note"}, {"input", "expect"})
                for key, value in given.items():
                    self.assertEqual(result["input"][key], value)
                for key in ("L_o", "L_o_integrand"):
                    if key in case["expect"]:
                        self.assertTrue(math.isclose(result["expect"][key], case["expect"][key], rel_tol=1e-6))
                for key, value in case["expect"]["NVar"].items():
                    if key == "optimal weights inv_m2" and given.get("joint"):
                        continue  # where the golden file may be wrong: tests/native/study has the right values
                    if value is not None and not key.endswith("_relerr"):
                        self.assertTrue(math.isclose(result["expect"]["NVar"][key], value, rel_tol=1e-6), key)
        self.assertGreater(len(seen), 10)

    def test_events_so_rare_that_the_trials_met_none_are_no_bias(self):
        """z of the strategies that learn is -15 here: their cosine samples meet the lobe once in thousands of trials."""
        case = ("--mode", "planar", "--alpha", "1e-6", "--theta-o", "60", "--integrand", "joint", "--rho-d", "0.3",
                "--samples", "256", "--trials", "400")  # fmt: skip
        runs = self.study(*case)["measured"]["runs"][0]["strategies"]
        self.assertLess(min(run["bias_z"] for run in runs.values()), -10)
        self.assertTrue(all(abs(run["bias_z"]) < 4 for run in runs.values() if run["judgeable"]), runs)
        self.assertTrue(runs["optimal"]["judgeable"])
        table = self.run_command("study", *case).stdout
        self.assertRegex(table, r"\nauto .* \?  ")
        self.assertIn("?: says nothing", table)
        self.assertNotIn("?", self.run_command("study").stdout)

    def test_planar_is_called_no_radiance(self):
        self.assertIn("no radiance", self.study("--trials", "0", "--mode", "planar")["note"])
        self.assertIn("no radiance", self.run_command("study", "--trials", "0", "--mode", "planar").stdout)

    def test_measured_agrees_with_exact_and_not_with_threads(self):
        result = self.study("--threads", "1")
        other = self.study("--threads", "2")
        strategies = result["measured"]["runs"][0]["strategies"]
        self.assertGreaterEqual(len(strategies), 20)
        for name, values in strategies.items():
            with self.subTest(name):
                self.assertEqual(values["mean"], other["measured"]["runs"][0]["strategies"][name]["mean"])
                self.assertLess(abs(values["bias_z"]), 4)
                self.assertGreater(values["seconds_per_trial"], 0)
                if not values["counts_follow_samples"]:
                    off = abs(values["variance"] - values["predicted_variance"]) / values["variance_error"]
                    self.assertLess(off, 5)
        tie = strategies["variance"]["nvar"] / strategies["equal"]["nvar"]
        self.assertAlmostEqual(tie, 1, 12)

    def test_auto_beats_equal_counts_where_the_theory_does(self):
        for extra in ((), ("--techniques", "lobe,cosine,uniform")):
            run = self.study("--strategies", "equal,auto", "--trials", "4000", *extra)["measured"]["runs"][0]
            self.assertLess(run["strategies"]["auto"]["variance"], 0.75 * run["strategies"]["equal"]["variance"])

    def test_auto_is_equal_where_nothing_is_to_be_gained(self):
        run = self.study("--alpha", "0.5", "--theta-o", "0", "--strategies", "equal,auto", "--trials", "4000")
        strategies = run["measured"]["runs"][0]["strategies"]
        self.assertLess(strategies["auto"]["variance"], 1.1 * strategies["equal"]["variance"])

    def test_costs_are_used(self):
        names = "equal,variance,standard-deviation,second-moment,best"
        free = self.study("--trials", "2", "--strategies", names)["measured"]["runs"][0]["strategies"]
        dear = self.study("--trials", "2", "--strategies", names, "--cost", "9,1")["measured"]["runs"][0]["strategies"]
        self.assertEqual(free["equal"]["fractions"], dear["equal"]["fractions"])
        for name, power in (("variance", 1), ("standard-deviation", 0.5), ("second-moment", 1)):
            a, b = free[name]["fractions"], dear[name]["fractions"]
            self.assertAlmostEqual((a[0] / a[1]) / (b[0] / b[1]) / 9**power, 1, 9)
        self.study("--trials", "2", "--cost", "measured")

    def test_range_csv_and_figures(self):
        table = self.folder / "s.csv"
        figure = self.folder / "a figure's name.svg"
        names = ["equal", "second-moment"]
        self.run_command(
            "study", "--samples", "16..128", "--trials", "50", "--strategies", ",".join(names), "--csv", table, "--plot", figure
        )  # fmt: skip
        with table.open() as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(
            [(r["samples"], r["strategy"]) for r in rows], [(str(n), s) for n in (16, 32, 64, 128) for s in names]
        )
        self.assertAlmostEqual(float(rows[0]["exact_integral"]), 0.25383768237261395, 9)
        self.assertIn("second-moment", figure.read_text())
        self.run_command("study", "--trials", "2", "--plot", self.folder / "s.png")
        self.assertEqual((self.folder / "s.png").read_bytes()[:4], b"\x89PNG")

    def test_csv_has_what_the_table_has(self):
        table = self.folder / "all.csv"
        result = self.study("--trials", "20", "--cost", "3,1,1", "--techniques", "lobe,cosine,uniform", "--csv", table)
        with table.open() as file:
            rows = list(csv.DictReader(file))
        for row in rows:
            run = result["measured"]["runs"][0]["strategies"][row["strategy"]]
            for key, column in (("fractions", "fraction"), ("counts", "count")):
                ours = [float(row[f"{column}_{t}"]) for t in ("lobe", "cosine", "uniform")]
                self.assertEqual(ours, run[key])
            self.assertEqual(float(row["variance_x_seconds"]), run["variance_x_seconds"])
            self.assertEqual(float(row["cost_ns_lobe"]), result["measured"]["cost_ns"][0])
            self.assertEqual(row["counts_follow_samples"], str(int(run["counts_follow_samples"])))
        self.assertEqual(len(rows), len(result["measured"]["runs"][0]["strategies"]))

    def test_intervals_of_few_trials(self):
        """None under four trials; from there on as often right as they say: of 24 of 95 %, 18 or less come by chance
        once in 1000 times."""
        covered = 0
        for seed in range(24):
            run = self.study("--alpha", "0.3", "--theta-o", "30", "--samples", "64", "--trials", "5",
                             "--strategies", "equal", "--seed", seed)["measured"]["runs"][0]["strategies"]["equal"]  # fmt: skip
            low, high = run["variance_95"]
            covered += low <= run["predicted_variance"] <= high
        self.assertGreater(covered, 18)
        few = self.study("--trials", "3", "--strategies", "equal")["measured"]["runs"][0]["strategies"]["equal"]
        self.assertEqual(few["variance_95"], [None, None])

    def test_planar_phong_is_at_normal_incidence(self):
        result = self.study("--trials", "0", "--mode", "planar", "--brdf", "lafortune-phong")
        self.assertEqual(result["input"]["theta_o_deg"], 0)

    def test_only_files_are_written(self):
        """A pipe, standing in for any device, stays; a link stays and what it names is written."""
        pipe = self.folder / "pipe.svg"
        os.mkfifo(pipe)
        for verb, option in (("study", "--csv"), ("study", "--plot"), ("stability", "--plot")):
            self.refused(4, verb, option, pipe, says=["device"])
            self.assertTrue(stat.S_ISFIFO(pipe.lstat().st_mode))
            self.refused(4, verb, option, self.folder / "none" / "a.svg", says=["folder does not exist"])
        (self.folder / "other").mkdir()
        for before in ("", None):  # what the link names is there, or not yet
            link, target = self.folder / f"link-{before is None}.csv", self.folder / "other" / f"{before is None}.csv"
            if before is not None:
                target.write_text(before)
            link.symlink_to(f"other/{target.name}")
            self.run_command("study", "--trials", "2", "--strategies", "equal", "--csv", link)
            self.assertTrue(link.is_symlink())
            self.assertTrue(target.read_text().startswith("strategy,"))
        self.assertEqual(sorted(path.name for path in (self.folder / "other").iterdir()), ["False.csv", "True.csv"])

    def test_figure_by_way_of_a_folder_of_any_name(self):
        """No shell reads it."""
        temporary = self.folder / 'it\'s a "$(touch away)" \\ `touch away`; touch away'
        temporary.mkdir()
        figure = self.folder / "s.svg"
        self.run_command("study", "--trials", "2", "--plot", figure, env={**os.environ, "TMPDIR": str(temporary)})
        self.assertIn("<svg", figure.read_text())
        self.assertEqual(list(temporary.iterdir()), [])
        self.assertFalse((self.folder / "away").exists() or Path("away").exists())

    def test_figure_without_gnuplot(self):
        done = self.refused(
            4, "study", "--trials", "2", "--plot", self.folder / "s.svg", says=["gnuplot", "install"], env={**os.environ, "PATH": ""}
        )  # fmt: skip
        self.assertFalse((self.folder / "s.svg").exists(), done.stderr)

    def test_the_paper_s_errors(self):
        done = self.run_command("study", "--paper").stdout
        for m, ratio in (("1", "2.513"), ("10", "3.561"), ("100", "5.34")):
            self.assertRegex(done, rf"\(11\), \(12\).*m = {m} \| {re.escape(ratio)} \|")
        # another quadrature of the printed formulas: the midpoint rule in theta, of 4 million steps, in numpy
        for where, of, ratio in (
            ("9", "m = 10, theta_o = 30", "1.294"),
            ("9", "m = 100, theta_o = 60", "3.885"),
            ("17", "alpha = 0.1, theta_o = 30", "7.821e-06"),
            ("18", "alpha = 0.1, theta_o = 60", "3.614"),
            ("19", "alpha = 0.1, theta_o = 30", "0.1077"),
            ("21", "alpha = 0.01, theta_o = 80", "0.9374"),
        ):
            self.assertRegex(done, rf"\| \({where}\) \|.*{of} \| {re.escape(ratio)} \|")
        self.assertRegex(done, r"\| split \| 60 \| 0.1 \| 1 \| 0.657 \| 0.4792 \|")

    def test_mistakes_end_with_2(self):
        for arguments, says in (
            (("--theta-o", "90"), "89.9999"),
            (("--alpha", "0"), "alpha"),
            (("--alpha", ""), "empty"),
            (("--alpha", "0.1", "--phi-o", "30"), "--phi-o means nothing"),
            (("--alpha", "0.1", "--alpha-x", "0.2"), "--alpha"),
            (("--brdf", "phong"), "lafortune-phong"),
            (("--mode", "planar", "--alpha-x", "0.2", "--alpha-y", "0.1"), "planar"),
            (("--mode", "planar", "--brdf", "lafortune-phong", "--theta-o", "60"), "--theta-o 0"),
            (("--m", "3"), "--m is no parameter of ward"),
            (("--brdf", "lafortune-phong", "--alpha", "0.2"), "--alpha is no parameter"),
            (("--brdf", "lafortune-phong", "--phi-o", "20"), "--phi-o is no parameter"),
            (("--mode", "planar", "--phi-o", "20"), "--phi-o"),
            (("--alpha-x", "0.2"), "--alpha-y"),
            (("--paper", "--alpha", "0.2"), "--alpha changes nothing"),
            (("--paper", "--csv", "a.csv"), "--csv changes nothing"),
            (("--csv", ""), "--csv"),
            (("--plot", ""), "--plot"),
            (("--csv", "same.svg", "--plot", "same.svg"), "both"),
            (("--rho-s", "0"), "nothing is left"),
            (("--samples", "1"), "--samples"),
            (("--samples", "16..8"), "--samples"),
            (("--samples", "2", "--techniques", "lobe,cosine,uniform"), "at least one"),
            (("--techniques", "lobe"), "two or three"),
            (("--techniques", "lobe,lobe"), "twice"),
            (("--strategies", "fair"), "second-moment"),
            (("--strategies", "equal,auto,equal"), "named twice"),
            (("--strategies", "second-order", "--techniques", "lobe,cosine,uniform"), "two techniques"),
            (("--cost", "1"), "2 numbers"),
            (("--cost", "1,-1"), "above 0"),
            (("--plot", "s.pdf"), ".svg"),
            (("--plot", "s.svg", "--trials", "0"), "--trials"),
            (("--rho-d", "nan"), "rho-d"),
            (("--seed", "-1"), "--seed"),
        ):
            with self.subTest(arguments):
                self.refused(2, "study", *arguments, says=[says])
