# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as files: what Blender itself writes is up to the colour management of its scene. No bpy in here.

Pixels are (height, width, 3), rows from the top.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np


def write_exr(path: Path, pixels: np.ndarray) -> None:
    """Scene-linear light, in 32 bits, not compressed."""
    height, width, _ = pixels.shape
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    # the channels in alphabetical order: 32 bits each, not subsampled
    channels = b"".join(name + struct.pack("<xiB3xii", 2, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    attributes = (
        (b"channels", b"chlist", channels),
        (b"compression", b"compression", b"\0"),
        (b"dataWindow", b"box2i", window),
        (b"displayWindow", b"box2i", window),
        (b"lineOrder", b"lineOrder", b"\0"),
        (b"pixelAspectRatio", b"float", struct.pack("<f", 1)),
        (b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)),
        (b"screenWindowWidth", b"float", struct.pack("<f", 1)),
    )
    header = struct.pack("<II", 20000630, 2)
    for name, kind, value in attributes:
        header += name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value
    header += b"\0"
    size = 12 * width
    lines = np.empty(height, np.dtype([("y", "<i4"), ("size", "<i4"), ("values", "<f4", (3, width))]))
    lines["y"], lines["size"] = np.arange(height), size
    lines["values"] = pixels[:, :, ::-1].transpose(0, 2, 1)
    offsets = len(header) + 8 * height + np.arange(height, dtype="<u8") * (8 + size)
    path.write_bytes(header + offsets.astype("<u8").tobytes() + lines.tobytes())


def write_png(path: Path, pixels: np.ndarray) -> None:
    """sRGB from 0 to 1, in 8 bits."""
    height, width, _ = pixels.shape
    rows: np.ndarray = np.zeros((height, 1 + 3 * width), np.uint8)  # each begins with its filter: none
    rows[:, 1:] = (np.clip(pixels, 0, 1) * 255 + 0.5).astype(np.uint8).reshape(height, -1)
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(rows.tobytes(), 1)),
        (b"IEND", b""),
    )
    data = b"\x89PNG\r\n\x1a\n"
    for kind, content in chunks:
        data += struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
    path.write_bytes(data)
