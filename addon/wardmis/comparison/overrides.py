# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings for a while. No bpy in here."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator
from typing import Any

Setting = tuple[Any, str, Any]  # owner, name, value


@contextlib.contextmanager
def overridden(settings: Iterable[Setting]) -> Iterator[None]:
    """Within it the settings hold, those at least that this version of Blender has; afterwards they are the user's again, also
    where they have been changed further meanwhile."""
    before: list[Setting] = []
    try:
        for owner, name, value in settings:
            if hasattr(owner, name):
                before.append((owner, name, getattr(owner, name)))
                _set(owner, name, value)
        yield
    finally:
        # the last first: one may have limited what another can be, as the kind of media does the file's format
        for owner, name, value in reversed(before):
            _set(owner, name, value)


def _set(owner: Any, name: str, value: Any) -> None:
    if getattr(owner, name) != value:  # else Blender would have to look at what has not changed
        setattr(owner, name, value)
