# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether two exports are of one scene. No bpy in here.

Blender's threads add up vertex normals in any order, so that the last bits of an export differ from time to time. What has been
rendered of one such file is as good for the other, and a comparison that was stopped must find its own scene again.
"""

from __future__ import annotations

import json
import shutil
import struct
from pathlib import Path
from typing import Any

import numpy as np

FLOAT = 5126  # glTF's number of the type
# of the largest number beside it (a mesh's size, a normal's length): some thirty times the last bit of a float
ROUNDING = 4e-6
BOUNDS = ("min", "max")  # of an accessor's values, which are compared themselves


def settle(exported: Path, place: Path, *, rendered: bool = False) -> None:
    """Moves `exported` to `place`, unless the file there is the same scene: then that one stays, bit for bit.

    OSError if it cannot; FileExistsError where the file there is another scene that has been `rendered`.
    """
    if same_but_for_rounding(exported, place):
        exported.unlink()
    elif rendered and place.exists():
        raise FileExistsError(place)
    else:
        shutil.move(exported, place)


def same_but_for_rounding(first: Path, second: Path) -> bool:
    """False too where either is missing or is no scene."""
    try:
        a, b = first.read_bytes(), second.read_bytes()
        return a == b or _same(*_parts(a), *_parts(b))
    except (OSError, ValueError, KeyError, IndexError, TypeError, struct.error):
        return False


def _parts(data: bytes) -> tuple[Any, np.ndarray]:
    """The document, and the bytes of the binary part. The latter can be written to."""
    (length,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + length]), np.frombuffer(data, np.uint8, offset=20 + length).copy()


def _same(document: Any, binary: np.ndarray, other: Any, other_binary: np.ndarray) -> bool:
    if len(binary) != len(other_binary) or _without_bounds(document) != _without_bounds(other):
        return False
    start = 8  # the chunk's header
    for accessor in document.get("accessors", []):
        if accessor["componentType"] != FLOAT:
            continue
        view = document["bufferViews"][accessor["bufferView"]]
        at = slice(start + view["byteOffset"], start + view["byteOffset"] + view["byteLength"])
        if not _close(binary[at].view("<f4"), other_binary[at].view("<f4")):
            return False
        binary[at] = other_binary[at] = 0  # has been compared
    return np.array_equal(binary, other_binary)  # indices, images


def _close(a: np.ndarray, b: np.ndarray) -> bool:
    if np.array_equal(a, b):
        return True
    difference = np.abs(a.astype(np.float64) - b)
    return bool(difference.max() <= ROUNDING * np.abs(a).max())  # not where one is no number


def _without_bounds(document: Any) -> Any:
    accessors = [{k: v for k, v in a.items() if k not in BOUNDS} for a in document.get("accessors", [])]
    return {**document, "accessors": accessors}
