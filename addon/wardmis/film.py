# SPDX-License-Identifier: GPL-3.0-or-later
"""What a pixel of the film makes of light: the settings that Cycles has in the scene, or the scene's own."""

from __future__ import annotations

from typing import Any, NamedTuple


class Film(NamedTuple):
    """`filter`: "box", "gaussian" or "blackman-harris"."""

    exposure: float = 1.0
    filter: str = "blackman-harris"
    width: float = 1.5

    def __str__(self) -> str:
        width = "" if self.filter == "box" else f" of {self.width:.3g} px"
        return f"exposure {self.exposure:.3g}, filter {self.filter}{width}"


def of_cycles(scene: Any) -> Film:
    """Its defaults where its add-on is off."""
    cycles = getattr(scene, "cycles", None)
    if cycles is None:
        return Film()
    return Film(cycles.film_exposure, cycles.pixel_filter_type.lower().replace("_", "-"), cycles.filter_width)


def in_force(scene: Any) -> Film:
    settings = scene.wardmis
    if settings.film == "cycles":
        return of_cycles(scene)
    return Film(settings.film_exposure, settings.filter_type, settings.filter_width)
