# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenEXR files for Python, which cannot read a loaded multi-layer image in Blender. No bpy in here.

Single-part scan-line files, uncompressed or deflated: what `wardmis` writes, and Blender as compat.multilayer_exr() has it.
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

MAGIC, VERSION_AND_FLAGS = 20000630, 2
LONG_NAMES = 0x400
LINES_OF_A_CHUNK = {0: 1, 2: 1, 3: 16}  # by compression: none, one line deflated, sixteen lines deflated
TYPES: dict[int, np.dtype[Any]] = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}


@dataclass
class Header:
    attributes: dict[str, bytes]
    end: int

    def text(self, name: str) -> str | None:
        value = self.attributes.get(name)
        return None if value is None else value.decode("utf-8", "replace")

    def channels(self) -> list[tuple[str, np.dtype[Any]]]:
        """In the order in which each line holds them."""
        data, at, result = self.attributes["channels"], 0, []
        while data[at]:
            end = data.index(b"\0", at)
            (kind,) = struct.unpack_from("<i", data, end + 1)
            result.append((data[at:end].decode("utf-8", "replace"), TYPES[kind]))
            at = end + 17
        return result


def read_header(path: Path) -> Header:
    return _header(path, path.read_bytes())


def _header(path: Path, data: bytes) -> Header:
    if len(data) < 8 or struct.unpack_from("<II", data)[0] != MAGIC:
        raise OSError(f"{path} is no OpenEXR file")
    if struct.unpack_from("<I", data, 4)[0] & ~LONG_NAMES != VERSION_AND_FLAGS:
        raise OSError(f"{path} is tiled, deep or of several parts, which this reader does not know")
    attributes, at = {}, 8
    try:
        while data[at]:
            name_end = data.index(b"\0", at)
            kind_end = data.index(b"\0", name_end + 1)
            (size,) = struct.unpack_from("<i", data, kind_end + 1)
            start = kind_end + 5
            attributes[data[at:name_end].decode("utf-8", "replace")] = data[start : start + size]
            at = start + size
    except (IndexError, ValueError, struct.error) as error:
        raise OSError(f"{path} is cut off") from error
    return Header(attributes, at + 1)


def read_pass(path: Path, name: str = "Combined") -> np.ndarray:
    """One pass, (height, width, channels) float32, rows from the top; channels in the order R G B A or X Y Z. OSError if it cannot be."""
    data = path.read_bytes()
    header = _header(path, data)
    channels = header.channels()
    wanted = sorted((c for c, _ in channels if c.split(".")[-2:-1] == [name]), key=lambda c: "RGBAXYZ".find(c[-1]))
    if not wanted and name == "Combined":  # no layers
        wanted = [c for c in "RGBA" if c in dict(channels)]
    if not wanted:
        raise OSError(f"{path} has no pass '{name}'")
    compression = header.attributes["compression"][0]
    if compression not in LINES_OF_A_CHUNK:
        raise OSError(f"{path} is compressed in a way that this reader does not know (number {compression})")
    x0, y0, x1, y1 = struct.unpack("<4i", header.attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    line_bytes = width * sum(kind.itemsize for _, kind in channels)
    image: np.ndarray = np.empty((height, width, len(wanted)), np.float32)
    chunks = -(-height // LINES_OF_A_CHUNK[compression])
    try:
        for offset in struct.unpack_from(f"<{chunks}Q", data, header.end):
            first, size = struct.unpack_from("<ii", data, offset)
            lines = min(LINES_OF_A_CHUNK[compression], y1 - first + 1)
            block = data[offset + 8 : offset + 8 + size]
            if size != lines * line_bytes:  # a block that would not shrink is stored as it is
                block = _undo_prediction(zlib.decompress(block))
            rows = np.frombuffer(block, np.uint8).reshape(lines, line_bytes)
            at = 0
            for channel, kind in channels:
                if channel in wanted:
                    part = np.ascontiguousarray(rows[:, at : at + width * kind.itemsize]).view(kind)
                    image[first - y0 : first - y0 + lines, :, wanted.index(channel)] = part
                at += width * kind.itemsize
    except (ValueError, zlib.error, struct.error) as error:
        raise OSError(f"{path} is damaged: {error}") from error
    return image


def _undo_prediction(data: bytes) -> bytes:
    """OpenEXR deflates differences of bytes, the even ones of the lines first."""
    values = np.frombuffer(data, np.uint8).astype(np.int64)
    values[1:] -= 128
    values = np.cumsum(values).astype(np.uint8)
    half = (len(values) + 1) // 2
    result = np.empty_like(values)
    result[::2], result[1::2] = values[:half], values[half:]
    return result.tobytes()
