# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison of the current scene, from a script: `wardmis.compare(folder)`."""

from __future__ import annotations

import contextlib
import dataclasses
import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import bpy

from .. import temporary
from ..lock import alone
from ..operators import export_scene
from ..preferences import renderer_path
from ..process import STOPPED, Renderer, RendererError
from . import interrupt
from .converge import DEFAULT_CONFIGURATIONS, Outcome, Study, arguments, explain_half
from .cycles import CyclesPlan, Progress, render_cycles, require_cycles
from .overrides import Setting, overridden
from .same_scene import settle
from .scene_file import read_scene_file

SCENE_NAME = "scene.glb"
CYCLES_FOLDER = "cycles"
RENDERED = ("study.json", f"{CYCLES_FOLDER}/manifest.json")  # a folder with one of them has renders of its scene
FEWEST_SEEDS = 2
FEWEST_SAMPLES = 2
POLL_SECONDS = 0.2


def compare(
    output: str | os.PathLike[str],
    *,
    configurations: Sequence[str] | None = None,
    seeds: int = 16,
    first_seed: int = 1,
    max_spp: int = 64,
    budget_seconds: float | None = None,
    cycles: bool = True,
    cycles_seeds: int | None = None,
    cycles_reference_spp: int | None = None,
    as_is: bool = False,
    baseline: str | None = None,
    reference: str | os.PathLike[str] | None = None,
    reference_time: float | None = None,
    target: float | None = None,
    title: str | None = None,
    threads: int | None = None,
    resolution: tuple[int, int] | str | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
) -> Outcome:
    """Compares configurations of WardMIS, and Cycles, on the current scene, frame and view layer; leaves everything in `output`.

    configurations   as the command's --configuration; "scene" is the scene's own settings (equal, variance, second-moment, auto)
    seeds            independent renders of each; cycles_seeds: of Cycles (as many)
    max_spp          renders have 1, 2, 4 ... max_spp samples per pixel
    budget_seconds   instead of max_spp; with Cycles, half of it is Cycles', which takes as many samples as WardMIS, or fewer
    resolution       width and height instead of the scene's: (480, 270) or "480x270"
    as_is            Cycles with the scene's settings for it, else with everything off that biases its image
    progress         is called with each event, a dictionary as in the command's JSON lines
    The others are the command's options (docs/command.md). The same call again goes on where the last one was stopped.

    Raises RuntimeError with a message for the user; its subclass interrupt.Stopped where the user has stopped it.
    """
    scene = bpy.context.scene
    study = Study(
        tuple(configurations or DEFAULT_CONFIGURATIONS),
        seeds,
        first_seed,
        max_spp,
        budget_seconds,
        baseline,
        _absolute(reference),
        reference_time,
        target,
        scene_title(scene) if title is None else title,
        threads_of(scene) if threads is None else threads,
    )
    tell = progress or (lambda _event: None)

    def note(event: dict[str, Any]) -> None:
        _note(event, outcome, tell)

    folder = Path(bpy.path.abspath(os.fspath(output))).absolute()
    try:
        command = [str(renderer_path())]
    except RendererError as error:
        raise RuntimeError(f"WardMIS: {error}") from error
    if cycles:
        require_cycles(scene)
    new = not folder.exists()
    with overridden(_resolution(scene, resolution)):
        outcome = prepare(folder, study)
        try:
            if cycles:
                plan, study = divide(study, cycles_seeds, cycles_reference_spp, as_is)
                own = [*command, *arguments(study, scene.wardmis, outcome)]
                if study.budget_seconds is None:
                    _check([*own, "--check"], outcome)
                else:  # which finds out how many samples there are to be
                    _converge(own, outcome, note)
                renders = outcome.folder / CYCLES_FOLDER
                outcome.manifest = render_cycles(renders, read_scene_file(outcome.scene), plan, note)
            _converge([*command, *arguments(study, scene.wardmis, outcome)], outcome, note)
        except interrupt.Stopped:
            raise
        except RuntimeError as error:
            if new:
                forget(outcome)
            raise RuntimeError(explain_half(str(error)) if cycles else str(error)) from error
        return outcome


def size_of(resolution: tuple[int, int] | str) -> tuple[int, int]:
    """Raises RuntimeError with a message for the user."""
    parts = resolution if isinstance(resolution, tuple | list) else (resolution,)
    match = re.fullmatch(r"(\d+)x(\d+)", "x".join(map(str, parts)))
    width, height = map(int, match.groups()) if match else (0, 0)
    if min(width, height) < 4:
        raise RuntimeError(f"{resolution!r} is no size of at least 4 x 4 pixels, as 480x270 is")
    return width, height


def _resolution(scene: Any, resolution: tuple[int, int] | str | None) -> list[Setting]:
    if resolution is None:
        return []
    render = scene.render
    width, height = size_of(resolution)
    return [
        (render, "resolution_x", width),
        (render, "resolution_y", height),
        (render, "resolution_percentage", 100),
    ]


def check_study(study: Study) -> None:
    """Raises RuntimeError for what cannot be compared."""
    if study.seeds < FEWEST_SEEDS:
        raise RuntimeError(
            f"WardMIS: {study.seeds} seeds cannot tell how sure a figure is; take at least {FEWEST_SEEDS}"
        )
    if study.budget_seconds is not None and not study.budget_seconds > 0:
        raise RuntimeError(f"WardMIS: a budget of {study.budget_seconds:g} seconds is none; give how long it may take")
    if study.max_spp < FEWEST_SAMPLES:
        raise RuntimeError(f"WardMIS: {study.max_spp} samples per pixel make no curve; take at least {FEWEST_SAMPLES}")


def prepare(folder: Path, study: Study) -> Outcome:
    """Checks what is asked for, makes the folder and exports the scene into it, where it does not hold the same one already.

    Refuses a folder with renders of another scene.
    """
    check_study(study)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RuntimeError(
            f"WardMIS: the folder {folder} cannot be made: {error.strerror}; choose another output folder"
        ) from error
    outcome = Outcome(folder, folder / SCENE_NAME)
    try:
        with temporary.folder() as place:
            export_scene(place / SCENE_NAME)
            rendered = any((folder / name).exists() for name in RENDERED)
            settle(place / SCENE_NAME, outcome.scene, rendered=rendered)
        interrupt.check(folder)
    except FileExistsError as error:
        raise RuntimeError(
            f"WardMIS: {folder} holds a comparison of another scene, which stays as it is; "
            "choose another output folder, or delete that one"
        ) from error
    except OSError as error:
        raise RuntimeError(
            f"WardMIS: {outcome.scene} cannot be written: {error.strerror}; make room, or choose another output folder"
        ) from error
    return outcome


def divide(
    study: Study, cycles_seeds: int | None, cycles_reference_spp: int | None, as_is: bool
) -> tuple[CyclesPlan, Study]:
    """Cycles' part of the comparison, and WardMIS'."""
    seeds = study.seeds if cycles_seeds is None else cycles_seeds
    if seeds < FEWEST_SEEDS:
        raise RuntimeError(
            f"WardMIS: {seeds} seeds of Cycles cannot tell how sure a figure is; take at least {FEWEST_SEEDS}"
        )
    half = None if study.budget_seconds is None else study.budget_seconds / 2
    first = study.first_seed
    plan = CyclesPlan(
        list(range(first, first + seeds)), study.max_spp, cycles_reference_spp, as_is, study.threads, half
    )
    return plan, dataclasses.replace(study, budget_seconds=half)


def forget(outcome: Outcome) -> None:
    """Of a comparison that has made its folder, was refused and has rendered nothing, nothing stays."""
    with contextlib.suppress(OSError, RuntimeError), alone(outcome.folder):
        if any((outcome.folder / name).exists() for name in RENDERED):
            return
        outcome.scene.unlink(missing_ok=True)
        with contextlib.suppress(OSError):
            (outcome.folder / CYCLES_FOLDER).rmdir()
        outcome.folder.rmdir()


def scene_title(scene: Any) -> str:
    return bpy.path.display_name_from_filepath(bpy.data.filepath) if bpy.data.filepath else str(scene.name)


def threads_of(scene: Any) -> int:
    """As many as a render takes (engine.py); 0 is all."""
    render = scene.render
    return render.threads if render.threads_mode == "FIXED" else 0


def _absolute(path: str | os.PathLike[str] | None) -> Path | None:
    return None if path is None else Path(bpy.path.abspath(os.fspath(path))).absolute()


def _check(command: list[str], outcome: Outcome) -> None:
    """A mistake in what is asked for shows before Cycles takes its time."""
    _run(command, outcome, lambda _event: None)


def _converge(command: list[str], outcome: Outcome, note: Progress) -> None:
    said = _run(command, outcome, note)
    if not outcome.report_json.is_file():
        raise RuntimeError(f"WardMIS: the renderer {command[0]} ended without a report{said}")


def _run(command: list[str], outcome: Outcome, note: Progress) -> str:
    """Until the renderer ends; returns what it said besides events."""
    interrupted = False
    try:
        with Renderer(command) as renderer:
            while renderer.running():
                if interrupt.requested() and not interrupted:
                    interrupted = True
                    renderer.interrupt()  # it ends with a report of what is done, if that is enough for one
                for event in renderer.events(POLL_SECONDS):
                    note(event)
            if renderer.exit_code() == STOPPED or (interrupted and renderer.exit_code() != 0):
                raise interrupt.Stopped(outcome.folder)
            for event in renderer.finish():
                note(event)
            return renderer.said()
    except RendererError as error:
        raise RuntimeError(f"WardMIS: {error}") from error


def _note(event: dict[str, Any], outcome: Outcome, tell: Progress) -> None:
    if event.get("event") == "warning":
        message = str(event.get("message"))
        if message in outcome.warnings:  # the renderer is asked twice where there is a budget
            return
        outcome.warnings.append(message)
    tell(event)
