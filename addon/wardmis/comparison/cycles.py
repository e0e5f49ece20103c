# SPDX-License-Identifier: GPL-3.0-or-later
"""The same scene by Cycles, in this Blender: a render for each seed and number of samples, and images to take its errors against.

How long a render took: Cycles itself states, with each image, the seconds that it rendered apart from those in which it synchronised
the scene (which includes building its BVH), cut off to hundredths. Blender's operator, and a clock around it, know the sum alone. The
CPU time is this process', less that of renders of a single pixel with one sample, which synchronise the same scene.
"""

from __future__ import annotations

import contextlib
import math
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy

from .. import film, light_paths
from ..exr import read_header
from ..lock import alone
from . import cycles_settings, interrupt
from .converge import checkpoints, chosen_spp
from .manifest import Manifest
from .overrides import overridden
from .scene_file import SceneFile

# samples of each of the reference images, over the largest number of a run; fewer where a budget would not suffice
REFERENCE_FACTORS = 8, 4, 2
REFERENCE_IMAGES = 4  # independent ones, so that the variance of their mean is known
# far from any that a run has, so that nothing is compared with its own samples
REFERENCE_SEED = 1_000_003
CUT_OFF_SECONDS = 0.01  # Cycles states its time without what is below
ONE_PIXEL_RENDERS = 3
PROBE_SAMPLES = 8  # of the render that tells what a sample costs, where there is a budget
FEWEST_OF_BUDGET = 4  # samples for which a budget must suffice, as WardMIS' own
FEWEST_SEEDS_OF_BUDGET = 4  # it cuts what are more, as WardMIS' own
BUDGET_SHARE = 0.9  # the rest is for what cannot be foreseen
MARGIN = 1.25  # of a time that is said to be enough: speeds vary
CERTAIN = 5  # a CPU time is stated where it is so many times as large as what the synchronisation varies by
WITHOUT_DENOISER = (
    "Cycles' images are not denoised, as the scene's settings would have it: this Blender was built without Open Image Denoise; "
    "use one from blender.org to compare with denoising"
)

Progress = Callable[[dict[str, Any]], None]


@dataclass
class CyclesPlan:
    seeds: list[int]
    max_spp: int  # samples per pixel of the last checkpoint
    reference_spp: int | None = None  # of each of the REFERENCE_IMAGES; else REFERENCE_FACTORS times a run's
    as_is: bool = False
    threads: int = 0
    # then there are at most as many samples as WardMIS' own study has chosen, which stands in the folder above
    budget_seconds: float | None = None

    def reference_of(self, max_spp: int, factor: int = REFERENCE_FACTORS[0]) -> int:
        return self.reference_spp or factor * max_spp


def require_cycles(scene: Any) -> None:
    """Raises RuntimeError where there is none."""
    if not hasattr(scene, "cycles"):
        raise RuntimeError(
            "WardMIS: Cycles is not there to be compared with: its add-on is off; turn it on in Preferences > Add-ons > Cycles Render "
            "Engine, or compare without Cycles"
        )


def render_cycles(folder: Path, scene_file: SceneFile, plan: CyclesPlan, progress: Progress) -> Path:
    """Renders what `folder` does not hold yet; returns the manifest's path. Raises RuntimeError with a message for the user."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    require_cycles(scene)
    folder.mkdir(parents=True, exist_ok=True)
    own_film = film.of_cycles(scene)
    settings = list(cycles_settings.frame(scene, layer, scene_file.film, plan.threads))
    lost = []  # of the settings that are to be kept
    if not plan.as_is:
        settings += cycles_settings.unbiased(scene, light_paths.in_force(scene))
    elif cycles_settings.lacks_denoiser(scene):
        settings.append((scene.cycles, "use_denoising", False))
        lost.append(WITHOUT_DENOISER)
        progress({"event": "warning", "message": WITHOUT_DENOISER})
    with overridden(settings), alone(folder):
        about = _about(scene, layer, scene_file, plan, lost)
        if own_film != film.in_force(scene):
            about["notes"].append(
                f"Cycles' film is WardMIS' own, not the scene's of {own_film}: the same with its Film set to As Cycles"
            )
        x0, y0, x1, y1 = scene_file.film["border"]
        manifest = Manifest(folder / "manifest.json", about, (y1 - y0, x1 - x0))
        for path in manifest.damaged:
            progress({"event": "warning", "message": f"{path} is damaged; it is rendered again"})
        _Renders(scene, layer, manifest, plan, progress).run()
    return manifest.path


def _about(scene: Any, layer: Any, scene_file: SceneFile, plan: CyclesPlan, lost: list[str]) -> dict[str, Any]:
    different = scene_file.other_than_blenders()
    notes = [
        "Cycles renders in one block of time, not in turns with WardMIS' configurations as these do among themselves",
        "seconds are those that Cycles states as its render time: without the synchronisation of the scene, to 0.01 s",
        f"CPU seconds are the process', less the median of {ONE_PIXEL_RENDERS} renders of one pixel, which synchronise the same scene",
    ]
    if plan.as_is:
        notes.append(
            "Cycles' settings are the scene's own, with whatever bias they bring; only exposure, filter, frame, seed and samples are set"
        )
        notes += lost
        own, limits = light_paths.of_cycles(scene), light_paths.in_force(scene)
        if light_paths.ends_sooner(own, limits) or light_paths.ends_sooner(limits, own):
            notes.append(
                f"Cycles' paths have bounces of {own}, WardMIS' of {limits}: the same with its Bounces set to As Cycles"
            )
    else:
        notes.append(f"paths end after the same bounces in both: {light_paths.in_force(scene)}")
        notes.append(
            "clamping, filtered glossiness, light threshold, adaptive sampling, denoising and fast GI are off; "
            "the first sample of Cycles' sequence, which lies in the middle of each pixel whatever the filter, is left out"
        )
    notes += different
    return {
        "name": "Cycles as set" if plan.as_is else "Cycles",
        "renderer": f"Cycles {bpy.app.version_string}",
        "settings": {
            "scene_sha256": scene_file.sha256,
            "view_layer": layer.name,
            "device": "CPU",
            "threads": plan.threads or "all",
            "as_is": plan.as_is,
            **cycles_settings.described(scene),
        },
        "notes": notes,
        # as the user has them, its settings may take light away
        "common_reference": not different and not plan.as_is,
    }


class _Renders:
    def __init__(self, scene: Any, layer: Any, manifest: Manifest, plan: CyclesPlan, progress: Progress) -> None:
        self.scene, self.layer = scene, layer
        self.manifest, self.plan, self.progress = manifest, plan, progress
        self.place = manifest.path.parent.parent  # the folder of the whole comparison
        self.one_pixel_cpu: list[float] = []
        self.began = time.monotonic()
        self.work: list[tuple[str, int, int]] = []
        self.all = self.done = 0

    def _decide_samples(self) -> int:
        """Samples per pixel of the last checkpoint."""
        plan, manifest = self.plan, self.manifest
        if plan.budget_seconds is None:
            spp, reference = plan.max_spp, plan.reference_of(plan.max_spp)
        elif manifest.max_spp:  # once it has decided, the comparison goes on as it began
            spp, reference = manifest.max_spp, plan.reference_spp or manifest.reference_spp
        else:
            spp, reference = self._affordable(plan.budget_seconds, chosen_spp(self.place))
        manifest.decide(spp, reference)
        return spp

    def _affordable(self, budget: float, most: int) -> tuple[int, int]:
        """The largest number of samples, and then of the reference's, whose renders fit into the budget."""
        self.progress({"event": "progress", "phase": "Cycles' speed", "fraction": 0.0})
        plan = self.plan
        synchronisation = self._measure_synchronisation()
        wall, _ = self._timed(PROBE_SAMPLES, 0)
        sample = max(0.0, wall - synchronisation) / PROBE_SAMPLES
        spent = time.monotonic() - self.began

        def seconds(spp: int, seeds: int, factor: int) -> float:
            points = checkpoints(spp)
            run = len(points) * synchronisation + sum(points) * sample
            reference = synchronisation + plan.reference_of(spp, factor) * sample
            return spent + seeds * run + REFERENCE_IMAGES * reference

        possible = [spp for spp in checkpoints(most) if spp >= FEWEST_OF_BUDGET] or [most]
        fewest_seeds = min(FEWEST_SEEDS_OF_BUDGET, len(plan.seeds))
        for seeds in (len(plan.seeds), fewest_seeds):  # there are as many as the time allows
            for factor in REFERENCE_FACTORS:
                for spp in reversed(possible):
                    if seconds(spp, seeds, factor) <= BUDGET_SHARE * budget:
                        return spp, plan.reference_of(spp, factor)
        needed = seconds(possible[0], fewest_seeds, REFERENCE_FACTORS[-1])
        raise RuntimeError(
            f"WardMIS: {possible[0]} samples per pixel by Cycles take about {needed:.0f} s here, with {fewest_seeds} "
            f"seeds and the reference, and its half of the budget is {budget:.3g} s; give at least "
            f"{math.ceil(MARGIN * 2 * needed / BUDGET_SHARE)} s in all, or fewer seeds of Cycles or a lower resolution, "
            f"and another output folder; {self.place} keeps the report without it"
        )

    def _work_left(self, points: list[int]) -> list[tuple[str, int, int]]:
        """(kind, seed, spp): two seeds first, without which there is no interval, then the reference, then the other seeds."""
        runs = [("run", seed, spp) for seed in self.plan.seeds for spp in points]
        first = 2 * len(points)
        references = [("reference", REFERENCE_SEED + i, self.manifest.reference_spp) for i in range(REFERENCE_IMAGES)]
        work = [*runs[:first], *references, *runs[first:]]
        return [item for item in work if not self._is_there(*item)]

    def _is_there(self, kind: str, seed: int, spp: int) -> bool:
        return (
            self.manifest.has_run(seed, spp) if kind == "run" else self.manifest.has_reference(_name(kind, seed, spp))
        )

    def run(self) -> None:
        self.work = self._work_left(checkpoints(self._decide_samples()))
        self.all = sum(spp for _, _, spp in self.work)
        if not self.work:
            return
        if not self.one_pixel_cpu:
            self._measure_synchronisation()
        needed = {("run", seed) for seed in self.plan.seeds[:2]}
        unit = None  # the seed, or the reference, that is being rendered
        for kind, seed, spp in self.work:
            if (kind, seed) != unit and kind == "run" and (kind, seed) not in needed and self._out_of_time():
                break  # a seed has all of its checkpoints, or is not begun
            unit = (kind, seed)
            self._say(kind, seed)
            self._render(kind, seed, spp)
            self.done += spp
        self._say("run", self.plan.seeds[-1])

    def _out_of_time(self) -> bool:
        budget = self.plan.budget_seconds
        return budget is not None and time.monotonic() - self.began >= budget

    def _say(self, kind: str, seed: int) -> None:
        seconds = time.monotonic() - self.began
        fraction = self.done / self.all
        self.progress(
            {
                "event": "progress",
                "phase": "Cycles" if kind == "run" else "Cycles' reference",
                "configuration": None,
                "seed": seed if kind == "run" else None,
                "done": self.done,
                "of": self.all,
                "fraction": fraction,
                "seconds": seconds,
                "left": seconds * (1 - fraction) / fraction if fraction else None,
            }
        )

    def _measure_synchronisation(self) -> float:
        """Of the scene, with all that is not sampling: returns its wall seconds, and notes the CPU's."""
        render = self.scene.render
        width, height = (
            max(1, n * render.resolution_percentage // 100) for n in (render.resolution_x, render.resolution_y)
        )
        x, y = width // 2, height // 2
        pixel = [
            (render, "use_border", True),
            (render, "border_min_x", (x + 0.25) / width),
            (render, "border_max_x", min(1.0, (x + 1.25) / width)),
            (render, "border_min_y", (y + 0.25) / height),
            (render, "border_max_y", min(1.0, (y + 1.25) / height)),
        ]
        with overridden(pixel):
            # the first one reads images and loads kernels
            times = [self._timed(1, 0) for _ in range(1 + ONE_PIXEL_RENDERS)][1:]
        self.one_pixel_cpu = [cpu for _, cpu in times]
        return statistics.median(wall for wall, _ in times)

    def _timed(self, spp: int, seed: int) -> tuple[float, float]:
        """Renders; returns the wall seconds that took, and the CPU seconds of this process."""
        for owner, name, value in cycles_settings.samples(self.scene, spp, seed, self.plan.as_is):
            setattr(owner, name, value)
        began, cpu_began = time.monotonic(), time.process_time()
        try:
            with interrupt.busy(self.place), _cancellation() as cancelled:
                ended = bpy.ops.render.render(scene=self.scene.name, layer=self.layer.name)
        except interrupt.Stopped:
            raise
        except RuntimeError as error:
            reason = str(error).strip().removeprefix("Error: ")
            raise RuntimeError(
                f"WardMIS: Cycles could not render the scene: {reason}; change what stops its own render, too"
            ) from error
        if cancelled or "FINISHED" not in ended:
            raise interrupt.Stopped(self.place)
        return time.monotonic() - began, time.process_time() - cpu_began

    def _render(self, kind: str, seed: int, spp: int) -> None:
        _, spent = self._timed(spp, seed)
        cpu: float | None = spent - statistics.median(self.one_pixel_cpu)
        if cpu is not None and cpu < CERTAIN * (max(self.one_pixel_cpu) - min(self.one_pixel_cpu)):
            cpu = None
        name = _name(kind, seed, spp)
        self._save(self.manifest.path.parent / name)
        if kind == "run":
            self.manifest.add_run(seed, spp, name, self._stated_seconds(name), cpu)
        else:
            self.manifest.add_reference(name)

    def _save(self, path: Path) -> None:
        temporary = path.with_name(f".{path.name}.tmp.exr")
        try:
            bpy.data.images["Render Result"].save_render(str(temporary), scene=self.scene)
            temporary.replace(path)
        except (OSError, RuntimeError) as error:
            raise RuntimeError(
                f"WardMIS: Cycles' image {path} cannot be written: {str(error).strip()}; make room, or choose another output folder"
            ) from error
        finally:
            temporary.unlink(missing_ok=True)

    def _stated_seconds(self, name: str) -> float | None:
        text = read_header(self.manifest.path.parent / name).text(f"cycles.{self.layer.name}.render_time")
        return None if text is None else _clock_seconds(text) + CUT_OFF_SECONDS / 2


@contextlib.contextmanager
def _cancellation() -> Iterator[list[bool]]:
    """Has something in it after a render that was cancelled: Blender says FINISHED of that one too, and has a part of its image."""
    cancelled: list[bool] = []

    def note(*_: Any) -> None:
        cancelled.append(True)

    bpy.app.handlers.render_cancel.append(note)
    try:
        yield cancelled
    finally:
        bpy.app.handlers.render_cancel.remove(note)


def _name(kind: str, seed: int, spp: int) -> str:
    return f"{kind}-{seed:04}-{spp:05}.exr"


def _clock_seconds(text: str) -> float:
    """'01:02.50', with hours in front where there are any."""
    seconds = 0.0
    for part in text.split(":"):
        seconds = seconds * 60 + float(part)
    return seconds
