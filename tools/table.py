# SPDX-License-Identifier: GPL-3.0-or-later
"""The demonstration's figures as a table: for a terminal, in Markdown, and in JSON."""

import json
from dataclasses import asdict, dataclass

CYCLES = "Cycles"  # among the allocations


@dataclass
class Row:
    scene: str
    allocation: str  # or CYCLES
    seconds: float  # pilot included; Cycles: its own render time
    pilot_seconds: float | None
    samples_per_pixel: int  # camera samples
    samples: int | None  # at the first hit, of all techniques
    rays: int | None
    rel_mse: float | None  # against a reference of this renderer; Cycles: where it shows the same materials
    rel_mse_trimmed: float | None


HEADINGS = [
    "scene",
    "allocation",
    "seconds",
    "of it pilot",
    "spp",
    "samples",
    "rays",
    "relMSE",
    "relMSE without worst 0.1 %",
]


def cells(row: Row) -> list[str]:
    def text(value: float | None, form: str) -> str:
        return "–" if value is None else format(value, form)

    return [
        row.scene,
        row.allocation,
        text(row.seconds, ".2f"),
        text(row.pilot_seconds, ".2f"),
        text(row.samples_per_pixel, "d"),
        text(row.samples, ",d"),
        text(row.rays, ",d"),
        text(row.rel_mse, ".5f"),
        text(row.rel_mse_trimmed, ".5f"),
    ]


def aligned(rows: list[Row]) -> list[list[str]]:
    table = [HEADINGS, *map(cells, rows)]
    widths = [max(len(line[i]) for line in table) for i in range(len(HEADINGS))]
    return [
        [
            cell.ljust(width) if i < 2 else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(line, widths, strict=True))
        ]
        for line in table
    ]


def plain(rows: list[Row], notes: list[str]) -> str:
    lines = ["  ".join(line).rstrip() for line in aligned(rows)]
    return "\n".join([lines[0], "-" * max(map(len, lines)), *lines[1:], "", *notes])


def markdown(rows: list[Row], notes: list[str]) -> str:
    head, *body = (f"| {' | '.join(line)} |" for line in aligned(rows))
    rule = "|" + "|".join(["---"] * 2 + ["---:"] * (len(HEADINGS) - 2)) + "|"
    return "\n".join([head, rule, *body, "", *(f"- {note}" for note in notes), ""])


# what single runs scatter by: of less nothing is said
SCATTER = 1.25


def verdict(rows: list[Row], baseline: str = "equal") -> str:
    """Which allocation one scene's `rows` speak for: error times time over the baseline's, since time buys less error."""
    # without the worst pixels: in one run a few fireflies would choose
    told = [r for r in rows if r.allocation != CYCLES]
    cost = {r.allocation: r.rel_mse_trimmed * r.seconds for r in told if r.rel_mse_trimmed is not None}
    ratios = {name: value / cost[baseline] for name, value in cost.items() if name != baseline}
    said = ", ".join(f"{name} {ratio:.2f}" for name, ratio in ratios.items())
    best = min(ratios, key=lambda name: ratios[name])
    scene = rows[0].scene
    if ratios[best] * SCATTER < 1:
        return f"{scene}: use {best}. Error times time, {baseline} being 1: {said}."
    return (
        f"{scene}: use {baseline}. Error times time, {baseline} being 1: {said}; none is better by more than the {SCATTER - 1:.0%} that single runs scatter by. "
        "The weights let each technique count where it is good, whatever its share; what other shares gain here is no more than what the pilot costs that finds them."
    )


def as_json(rows: list[Row], notes: list[str]) -> str:
    return json.dumps({"rows": [asdict(row) for row in rows], "notes": notes}, indent=2, ensure_ascii=False) + "\n"
