# SPDX-License-Identifier: GPL-3.0-or-later
"""What a path costs: beside the time that Embree alone takes for its rays, and as a scene grows. Processor time on one
thread of a render less that of a short one, pairs run in turn, medians; equal counts. Run by ./dev bench paths."""

import argparse
import json
import math
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median

import blender
from blender import ROOT
from markdown import table

SHORT, LONG, ROUNDS = 4, 20, 5  # samples per pixel; pairs
LIMITED = ("veach", "teapot", "teapot-direct", "triangles-1000000")
CONNECTED = "ajar"  # of paths from both ends
GROWING = {
    "lamps": (1, 9, 100, 1024, 10000),
    "glowing": (2, 200, 20000, 1000000),
    "triangles": (10000, 100000, 1000000, 5000000),
    "instances": (100, 10000, 1000000),
}


@dataclass
class Measured:
    """A scene's paths, in microseconds of one core."""

    scene: str
    time: float
    low: float  # of the rounds
    high: float
    rays: float
    embree: float | None = None  # alone, for the same rays


class Bench:
    def __init__(self, folder: Path, binary: str, probe: str, resolution: str) -> None:
        self.folder, self.binary, self.probe, self.resolution = folder, binary, probe, resolution

    def render(self, scene: Path, samples: int, *options: str, probe: bool = False) -> tuple[dict, dict]:
        """Its statistics, and what the probe tells of Embree."""
        stats = self.folder / "stats.json"
        words = [self.binary, "render", scene, "-o", self.folder / "image.exr", "--spp", samples, "--stats", stats]
        words += ["--threads", 1, "--pixels", "even", "--allocation", "equal", "--progress", "none"]
        words += [] if "--resolution" in options else ["--resolution", self.resolution]
        environment = {**os.environ, **({"LD_PRELOAD": self.probe} if probe else {})}
        done = subprocess.run(
            [*map(str, words), *options], env=environment, capture_output=True, text=True, check=False
        )
        if done.returncode != 0:
            sys.exit(f"bench: {scene.name}: {done.stderr.strip()}")
        told = json.loads(done.stderr.splitlines()[-1]) if probe else {}
        return json.loads(stats.read_text()), told

    def bytes_per_pixel(self, name: str, *options: str) -> float:
        """By which the process grows with the image."""
        scene, peaks = blender.exported(name, self.folder), []
        for side in (512, 1024):
            words = [self.binary, "render", scene, "-o", self.folder / "image.exr", "--spp", 32, "--progress", "none"]
            words += ["--resolution", f"{side}x{side}", *options]
            process = subprocess.Popen([*map(str, words)], stdout=subprocess.DEVNULL)
            peaks.append(1024 * os.wait4(process.pid, 0)[2].ru_maxrss)
        return (peaks[1] - peaks[0]) / (1024**2 - 512**2)

    def path(self, name: str, *options: str, limit: bool = False) -> Measured:
        scene = blender.exported(name, self.folder)
        times, rays = [], 0.0
        for _ in range(ROUNDS):
            (short, _), (long, _) = self.render(scene, SHORT, *options), self.render(scene, LONG, *options)
            paths = long["camera_paths"] - short["camera_paths"]
            times.append(1e6 * (long["cpu_seconds"]["render"] - short["cpu_seconds"]["render"]) / paths)
            rays = (long["rays"]["total"] - short["rays"]["total"]) / paths
        found = Measured(" ".join((name, *options)), median(times), min(times), max(times), rays)
        if limit:
            (short, few), (long, many) = (self.render(scene, n, *options, probe=True) for n in (SHORT, LONG))
            queries = (many["queries"] - few["queries"]) / (long["camera_paths"] - short["camera_paths"])
            found.embree = 1e6 * queries * many["seconds"] / many["queries"]
        return found


def exponent(numbers: Sequence[float], times: Sequence[float]) -> float:
    """Of the power of the number by which times grow from the first to the last."""
    return math.log(times[-1] / times[0]) / math.log(numbers[-1] / numbers[0])


def main() -> int:
    parser = argparse.ArgumentParser(prog="./dev bench paths", description=__doc__)
    parser.add_argument("--resolution", default="240x160", help="WxH (%(default)s)")
    parser.add_argument("--largest", type=float, default=1e7, help="number of things in a scene, at most (%(default)g)")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "bench", help="scenes and paths.json (%(default)s)")
    options = parser.parse_args()
    options.out = options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    bench = Bench(options.out, os.environ["WARDMIS_BINARY"], os.environ["WARDMIS_PROBE"], options.resolution)

    limits = []
    for name in LIMITED:
        if name.rpartition("-")[2].isdigit() and int(name.rpartition("-")[2]) > options.largest:
            continue
        integrator = ("--integrator", "direct" if name.endswith("direct") else "path")
        limits.append(bench.path(name.removesuffix("-direct"), *integrator, limit=True))
    limits.append(bench.path(CONNECTED, "--integrator", "bidirectional", limit=True))
    kernels = [bench.path("teapot", "--integrator", "direct", "--kernel", kernel) for kernel in ("auto", "general")]
    memory = {rule: bench.bytes_per_pixel("veach", "--allocation", rule) for rule in ("equal", "second-moment", "auto")}
    growing = {
        kind: {n: bench.path(f"{kind}-{n}") for n in numbers if n <= options.largest}
        for kind, numbers in GROWING.items()
    }
    print(
        table(
            ("scene", "µs a path", "rays", "Embree alone, µs", "ratio"),
            [
                (p.scene, f"{p.time:.2f}", f"{p.rays:.1f}", f"{p.embree:.2f}", f"{p.time / p.embree:.1f}")
                for p in limits
                if p.embree
            ],
        )
    )
    print(
        f"The general kernel takes {kernels[1].time / kernels[0].time:.2f} of the time of the one for {kernels[0].scene}.\n"
    )
    said = ", ".join(f"{rule} {size:.0f}" for rule, size in memory.items())
    print(f"Memory grows by so many bytes a pixel, the file that is written included: {said}.\n")
    rows = []
    for kind, paths in growing.items():
        numbers, times = list(paths), [p.time for p in paths.values()]
        steps = ", ".join(f"{n}: {t / times[0]:.2f}" for n, t in zip(numbers, times, strict=True))
        rows.append((kind, f"{times[0]:.2f}", steps, f"{exponent(numbers, times):.2f}" if len(numbers) > 1 else ""))
    print(table(("of which there are more", "µs a path of the first", "time over the first's", "exponent"), rows))
    document = {
        "limits": [asdict(p) for p in limits],
        "kernels": [asdict(p) for p in kernels],
        "bytes_per_pixel": memory,
        "growing": {kind: {str(n): asdict(p) for n, p in paths.items()} for kind, paths in growing.items()},
    }
    (options.out / "paths.json").write_text(json.dumps(document, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
