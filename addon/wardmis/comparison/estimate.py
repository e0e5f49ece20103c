# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a comparison takes, before it is begun, and times in words. No bpy in here."""

from __future__ import annotations

from dataclasses import dataclass

from .converge import Study, checkpoints

REFERENCE_FACTOR = 16  # samples of the command's reference, over those of a run
CYCLES_REFERENCE_FACTORS = 32, 8  # of all of Cycles' reference images; with the least for which a budget has to suffice
FEWEST_SAMPLES, FEWEST_SEEDS = 4, 4  # for which a budget has to suffice
MEASURED_SAMPLES = 8  # of each configuration, and the first time once more, by which the command knows what one costs
SURVEY_SAMPLES = 16  # which the command takes twice besides, to tell where samples go and what they cost
OWN_SHARE, CYCLES_SHARE = 0.7, 0.9  # of a budget, for the runs
MARGIN = 1.25  # of a time that is said to be enough: speeds vary
GUESS = 400_000.0  # camera samples a second of a thread, where nothing has been rendered yet


@dataclass
class Speeds:
    """Camera samples a second, of all threads together; where they are not known, none."""

    own: float | None = None
    cycles: float | None = None


@dataclass
class Estimate:
    own: float  # seconds
    cycles: float
    guessed: bool  # from no render of the scene: of a budget, whether it suffices is not known
    needed: float = 0.0  # seconds that a budget has to have at least, as far as is known

    @property
    def seconds(self) -> float:
        return self.own + self.cycles


def estimate(study: Study, pixels: int, cycles_seeds: int | None, speeds: Speeds, threads: int) -> Estimate:
    """Of `study` at so many `pixels`; `cycles_seeds` is none without Cycles."""
    if study.budget_seconds is not None:
        half = study.budget_seconds / 2 if cycles_seeds is not None else 0.0
        unknown = speeds.own is None
        return Estimate(study.budget_seconds - half, half, unknown, _needed(study, pixels, cycles_seeds, speeds))
    guess = GUESS * threads
    samples = study.max_spp * (len(study.configurations) * study.seeds + REFERENCE_FACTOR)
    own = pixels * samples / (speeds.own or guess)
    if cycles_seeds is None:
        return Estimate(own, 0.0, speeds.own is None)
    samples = sum(checkpoints(study.max_spp)) * cycles_seeds + CYCLES_REFERENCE_FACTORS[0] * study.max_spp
    cycles = pixels * samples / (speeds.cycles or speeds.own or guess)
    return Estimate(own, cycles, speeds.own is None)


def _needed(study: Study, pixels: int, cycles_seeds: int | None, speeds: Speeds) -> float:
    """By the rules by which the command (native/report/converge.cpp) and cycles.py refuse a budget."""
    own = cycles = 0.0
    if speeds.own:
        configurations, seeds = len(study.configurations), min(FEWEST_SEEDS, study.seeds)
        measured = MEASURED_SAMPLES * (configurations + 1)
        samples = FEWEST_SAMPLES * configurations * seeds + measured + 2 * SURVEY_SAMPLES
        own = MARGIN * pixels * samples / speeds.own / OWN_SHARE
    if speeds.cycles and cycles_seeds is not None:
        seeds = min(FEWEST_SEEDS, cycles_seeds)
        samples = sum(checkpoints(FEWEST_SAMPLES)) * seeds + CYCLES_REFERENCE_FACTORS[1] * FEWEST_SAMPLES
        cycles = MARGIN * pixels * samples / speeds.cycles / CYCLES_SHARE
    return own if cycles_seeds is None else 2 * max(own, cycles)


def duration(seconds: float) -> str:
    """'40 s', '1 min 30 s', '12 min', '3 h 52 min', '2 days 5 h'."""
    s = max(0, round(seconds))
    if s < 60:
        return f"{s} s"
    if s < 300 and s % 60:
        return f"{s // 60} min {s % 60} s"
    minutes = round(s / 60)
    if minutes < 60:
        return f"{minutes} min"
    hours, minutes = divmod(minutes, 60)
    if hours < 48:
        return f"{hours} h {minutes} min" if minutes else f"{hours} h"
    days, hours = divmod(hours, 24)
    return f"{days} days {hours} h" if hours else f"{days} days"
