# SPDX-License-Identifier: GPL-3.0-or-later
"""How far light is followed, in Cycles' numbers: the scene's own limits, or those that Cycles has."""

from __future__ import annotations

from typing import Any, NamedTuple

LONGEST = 1024  # of the command, in surface hits and in bounces
TRANSPARENT = 8  # surfaces that a path passes straight, where nothing else is said


class Bounces(NamedTuple):
    """At most so many of a path. What a ray meets beyond still gives its own light, and reflects none.

    `transparent`: surfaces that it passes straight; these are not in the total.
    """

    total: int
    diffuse: int
    glossy: int
    transmission: int
    transparent: int

    def by_kind(self) -> dict[str, int]:
        """Of the kinds that the total limits, too."""
        return {kind: min(getattr(self, kind), self.total) for kind in ("diffuse", "glossy", "transmission")}

    def __str__(self) -> str:
        kinds = ", ".join(f"{bounces} {kind}" for kind, bounces in self.by_kind().items())
        return f"{self.total} in all, {kinds}; {self.transparent} transparent surfaces"


def of_cycles(scene: Any) -> Bounces:
    """Its defaults where its add-on is off."""
    cycles = getattr(scene, "cycles", None)
    defaults = {"max": 12, "diffuse": 4, "glossy": 4, "transmission": 12, "transparent_max": TRANSPARENT}
    return Bounces(*(getattr(cycles, f"{kind}_bounces", default) for kind, default in defaults.items()))


def of_paths(scene: Any) -> Bounces:
    """Those of the integrator Path."""
    settings = scene.wardmis
    if settings.bounces == "cycles":
        return of_cycles(scene)
    return Bounces(
        settings.max_depth - 1,
        settings.max_diffuse,
        settings.max_glossy,
        settings.max_transmission,
        settings.max_transparent,
    )


def in_force(scene: Any) -> Bounces:
    limits = of_paths(scene)
    return limits._replace(total=0) if scene.wardmis.integrator == "direct" else limits


def ends_sooner(a: Bounces, b: Bounces) -> bool:
    """Whether `a` leaves light out that `b` shows."""
    pairs = [(a.total, b.total), (a.transparent, b.transparent), *zip(a.by_kind().values(), b.by_kind().values())]
    return any(x < y for x, y in pairs)


def options(scene: Any) -> dict[str, int]:
    """For the command, without dashes; only the limits by kind that limit anything."""
    limits = of_paths(scene)
    result = {"max-depth": min(limits.total + 1, LONGEST)}
    for kind, bounces in limits.by_kind().items():
        if bounces < limits.total:
            result[f"max-{kind}"] = bounces
    if limits.transparent != TRANSPARENT:
        result["max-transparent"] = limits.transparent
    return result
