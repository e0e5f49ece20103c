# SPDX-License-Identifier: GPL-3.0-or-later
"""A table in Markdown: names to the left, numbers to the right."""

from collections.abc import Iterable, Sequence


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], names: int = 1) -> str:
    """names: columns of them, the first ones."""
    lines = [headings, ["---"] * names + ["---:"] * (len(headings) - names), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"
