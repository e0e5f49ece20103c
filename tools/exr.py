# SPDX-License-Identifier: GPL-3.0-or-later
"""Multi-layer OpenEXR files as numpy arrays, one a pass: rows from the top, (height, width, channels)."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

Pixels = NDArray[np.float32]


@dataclass
class Exr:
    passes: dict[str, Pixels]
    attributes: dict[str, object]


def read(path: Path) -> Exr:
    """Channels are named LAYER.PASS.CHANNEL; the layer is left out, since these files have one."""
    file = oiio.ImageInput.open(str(path))
    if file is None:
        raise OSError(f"{path}: {oiio.geterror()}")
    parts: dict[str, list[Pixels]] = {}
    attributes: dict[str, object] = {}
    part = 0
    while file.seek_subimage(part, 0):  # Blender 5 writes one part a pass
        spec = file.spec()
        pixels = np.asarray(file.read_image(part, 0, 0, spec.nchannels, oiio.FLOAT), np.float32)
        pixels = pixels.reshape(spec.height, spec.width, spec.nchannels)
        for i, channel in enumerate(spec.channelnames):
            name = channel.split(".")[-2] if "." in channel else "Combined"
            parts.setdefault(name, []).append(pixels[:, :, i])
        attributes |= {attribute.name: attribute.value for attribute in spec.extra_attribs}
        part += 1
    file.close()
    return Exr({name: np.stack(channels, axis=-1) for name, channels in parts.items()}, attributes)
