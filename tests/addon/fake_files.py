# SPDX-License-Identifier: GPL-3.0-or-later
"""What the fake renderer prints and writes."""

import array
import json
import os
import struct


def say(**event):
    print(json.dumps(event), flush=True)


def write_exr(path, layer, passes, film):
    """An uncompressed scan-line OpenEXR of 32-bit floats, by a temporary name and a rename."""
    x0, y0, x1, y1 = film["border"]
    full_width, full_height = film["resolution"]
    width, height = x1 - x0, y1 - y0
    channels = sorted(
        (f"{layer}.{name}.{channel}".encode(), k)
        for k, (name, letters) in enumerate(passes.items())
        for channel in letters
    )
    channel_list = b"".join(name + struct.pack("<xiB3xii", 2, 0, 1, 1) for name, _ in channels) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    attributes = (
        ("channels", "chlist", channel_list),
        ("compression", "compression", b"\0"),
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1)),
        ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        ("screenWindowWidth", "float", struct.pack("<f", 1)),
    )
    header = struct.pack("<II", 20000630, 2)
    for name, kind, value in attributes:
        header += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    header += b"\0"
    line_bytes = 8 + 4 * width * len(channels)
    start = len(header) + 8 * height
    with open(f"{path}.tmp", "wb") as file:
        file.write(header)
        file.write(struct.pack(f"<{height}Q", *(start + line_bytes * i for i in range(height))))
        for line in range(height):
            y = y1 - 1 - line  # files count from the top, borders from the bottom
            file.write(struct.pack("<ii", line, line_bytes - 8))
            for _, k in channels:
                file.write(
                    array.array("f", [k + x / full_width + 10 * y / full_height for x in range(x0, x1)]).tobytes()
                )
    os.rename(f"{path}.tmp", path)
