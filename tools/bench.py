# SPDX-License-Identifier: GPL-3.0-or-later
"""Error and time of the default beside Cycles', scene by scene, both in one run: each scene is compared as by
./dev compare, whose report has the figures. Run by ./dev bench scenes."""

import argparse
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import blender
from blender import ROOT
from markdown import table

SCENES = (
    "veach",
    "veach-direct",
    "teapot",
    "teapot-direct",
    "veach-mesh-lights",
    "door",
    "rooms",
    "window",
    "area-lamps",
    "image-sky",
    "studio",
)
DEFAULT, EQUAL = "auto", "equal"
AS_CYCLES = "as-cycles"  # one sample of the light and one of the surface at each vertex
# of a report pixels have equal samples, if it is not said otherwise
CONFIGURATIONS = (
    f"{DEFAULT}:allocation=auto,pixels=auto",
    EQUAL,
    f"{AS_CYCLES}:allocation=albedo,samples-per-hit=2",
)
NOT_MEASURED = "–"


@dataclass
class Interval:
    mean: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.mean:.2f} [{self.low:.2f}, {self.high:.2f}]"

    @classmethod
    def of(cls, ratio: dict[str, float] | None) -> "Interval | None":
        return None if ratio is None else cls(ratio["mean"], ratio["low"], ratio["high"])


@dataclass
class Row:
    scene: str
    cycles: str  # its version
    efficiency: Interval | None  # 1 / (relMSE x time) of the default over Cycles'
    over_equal: Interval | None  # the same over equal counts
    time: float  # of the default by that of Cycles, at the same camera samples
    time_as_cycles: float  # the same of paths as Cycles draws them
    clock: str  # of both: cpu, or wall where Cycles' renders are too short to tell
    error: float  # relMSE of the default
    common: bool  # both are held against one reference
    metric: str  # as the report has it

    def cells(self) -> list[str]:
        held = "one" if self.common else "its own"
        ratios = [NOT_MEASURED if r is None else str(r) for r in (self.efficiency, self.over_equal)]
        return [self.scene, *ratios, f"{self.time:.2f}", f"{self.time_as_cycles:.2f}", f"{self.error:.2g}", held]


HEADINGS = [
    "scene",
    "efficiency / Cycles'",
    "/ equal counts'",
    "time / Cycles'",
    "with its samples",
    "relMSE",
    "reference",
]


def row(scene: str, report: dict[str, Any]) -> Row:
    of = {c["name"]: c for c in report["configurations"]}
    # the default is the baseline, so a ratio is another's variance x time over its
    cycles, equal, own = of["Cycles"], of[EQUAL], of[DEFAULT]
    clock = report["effort_clock"]

    def time(configuration: dict[str, Any]) -> float:
        return float(configuration["curve"][-1][clock]["mean"] / cycles["curve"][-1][clock]["mean"])

    return Row(
        scene,
        cycles["renderer"],
        Interval.of(cycles["efficiency"]["ratio"]),
        Interval.of(equal["efficiency"]["ratio"]),
        time(own),
        time(of[AS_CYCLES]),
        clock,
        own["curve"][-1]["relmse"]["mean"],
        any(m["common"] for m in report["models"]),
        report["metric"],
    )


def compared(scene: str, options: argparse.Namespace, configurations: Sequence[str]) -> dict[str, Any]:
    """The report of ./dev compare on a scene of blend/bench_scenes.py."""
    print(f"bench: {scene}", file=sys.stderr, flush=True)
    folder = options.out
    blender.run("--python-exit-code", "1", "--python", ROOT / "blend" / "bench_scenes.py", "--", folder, scene)
    out = folder / scene
    shutil.rmtree(out, ignore_errors=True)  # an earlier one would be gone on with, not measured
    words = [*(w for c in configurations for w in ("-c", c)), "--seeds", options.seeds, "--cycles-seeds", options.seeds]
    words += ["--max-spp", options.samples, "--resolution", options.resolution]
    script = ROOT / "blend" / "compare.py"
    blender.run(folder / f"{scene}.blend", "--python-exit-code", "1", "--python", script, "--", "-o", out, *words)
    report: dict[str, Any] = json.loads((out / "report.json").read_text())
    return report


def converged(scene: str, study: Path, options: argparse.Namespace, *words: str | Path | int) -> dict[str, Any]:
    """The report of `wardmis converge` on a scene of blend/bench_scenes.py, or on its direct light alone."""
    glb = blender.exported(scene.removesuffix("-direct"), options.out)
    integrator = "direct" if scene.endswith("-direct") else "path"
    shutil.rmtree(study, ignore_errors=True)  # an earlier one would be gone on with, not measured
    command = [os.environ["WARDMIS_BINARY"], "converge", glb, "-o", study, "--integrator", integrator, *words]
    command += ["--seeds", options.seeds, "--max-spp", options.samples, "--resolution", options.resolution]
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"bench: {scene}: {done.stderr.strip()}")
    report: dict[str, Any] = json.loads((study / "report.json").read_text())
    return report


def of_all_pixels(metrics: dict[str, str]) -> str:
    """Says which scenes' reports, by their metric, have all pixels in their ratios; empty: none."""
    scenes = [scene for scene, metric in metrics.items() if metric != "relmse_trimmed"]
    if not scenes:
        return ""
    return (
        f"With all pixels: {', '.join(scenes)}. Of the others the worst 0.1 % are left out, since some seeds meet light "
        "that is rare; few seeds may not tell that.\n"
    )


def asked(verb: str, description: str | None, known: Sequence[str], found: str) -> argparse.Namespace:
    """What the command line asks for; its folder is there. found: what that will hold."""
    parser = argparse.ArgumentParser(prog=f"./dev bench {verb}", description=description)
    parser.add_argument("scenes", nargs="*", default=known, help=f"of: {' '.join(known)} (all)")
    parser.add_argument("--seeds", type=int, default=8, help="renders of each configuration (%(default)s)")
    parser.add_argument("--samples", type=int, default=64, help="camera samples per pixel (%(default)s)")
    parser.add_argument("--resolution", default="144x96", help="WxH (%(default)s)")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "bench", help=f"{found} (%(default)s)")
    options = parser.parse_args()
    if unknown := set(options.scenes) - set(known):
        parser.error(f"there is no scene {', '.join(sorted(unknown))}; there are: {' '.join(known)}")
    options.out = options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    return options


def main() -> int:
    options = asked("scenes", __doc__, SCENES, "reports and bench.json")
    rows: list[Row] = []
    for scene in options.scenes:
        try:
            rows.append(row(scene, compared(scene, options, CONFIGURATIONS)))
        except blender.RenderFailed as error:
            sys.exit(f"bench: {error}")
        (options.out / "bench.json").write_text(json.dumps([asdict(r) for r in rows], indent=1) + "\n")
    print(f"{rows[0].cycles}; {options.samples} samples per pixel, {options.resolution}, {options.seeds} seeds\n")
    print(table(HEADINGS, (r.cells() for r in rows)))
    print(of_all_pixels({r.scene: r.metric for r in rows}), end="")
    if short := [r.scene for r in rows if r.clock == "wall"]:
        print(f"By the wall clock, since Cycles' renders are too short for their processor time: {', '.join(short)}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
