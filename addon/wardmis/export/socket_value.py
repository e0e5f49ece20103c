# SPDX-License-Identifier: GPL-3.0-or-later
"""What is typed into a socket."""

from __future__ import annotations

from typing import Any

import numpy as np

from .tree import NodeUse


class NotFinite(Exception):
    """A number in the tree is NaN or infinite, and has been named in a note."""


def own_value(use: NodeUse, socket: Any) -> np.ndarray:
    """(3,): an RGB, a vector or three times a number; of an input, or of a node that is nothing but a value. Raises NotFinite."""
    if not hasattr(socket, "default_value") or isinstance(socket.default_value, str):
        return np.zeros(3)
    value = np.array(socket.default_value, float)
    value = (
        np.pad(value[:3], (0, 3 - len(value[:3]))) if value.ndim else np.full(3, value)
    )  # since 5.0 some vectors have two
    if not np.isfinite(value).all():
        instead = "the material is rendered as magenta" if use.owner.kind == "material" else "it gives no light"
        use.note(f"has a '{socket.name}' that is not a finite number; {instead}")
        raise NotFinite
    return value
