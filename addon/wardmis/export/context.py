# SPDX-License-Identifier: GPL-3.0-or-later
"""What the parts of an export share: the textures so far, the notes for the user, and whether to stop."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from .model import ImageData, TextureData, not_finite

WRAPS = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "clip", "MIRROR": "mirror"}
Tell = Callable[[str], None]  # what an export is doing now that takes long; "" afterwards
FILTERS = {"Linear": "linear", "Closest": "nearest", "Cubic": "cubic", "Smart": "cubic"}


class ExportError(Exception):
    """The scene cannot be exported; the message says what, where and what to do."""


class ExportCancelled(Exception):
    """The user pressed Esc during the export."""


class Note(str):
    """A sentence for the user that knows the object it is about."""

    def __new__(cls, text: str, owner: str) -> Note:
        note = super().__new__(cls, text)
        note.owner = owner
        return note

    owner: str


class ExportContext:
    """Handed to every part of the export; `owner` is the object being exported, for messages."""

    def __init__(
        self,
        export_image: Callable[[Any], ImageData],
        cancelled: Callable[[], bool] | None = None,
        frame: int = 1,
        tell: Tell | None = None,
    ) -> None:
        self.frame = frame  # of the scene
        self.layer: tuple[Any, ...] = ()  # what has the attributes of the view layer, the first that has one first
        self.images: list[ImageData] = []
        self.textures: list[TextureData] = []
        self.notes: list[str] = []
        self.owner = ""
        self.foldings: dict[Any, Any] = {}  # by tree: what folding.py finds out about it
        self.zones: dict[Any, Any] = {}  # by tree: tree.py's
        self.computed: dict[Any, bool] = {}  # by node, and what is entered to reach it: unrolled.py's
        self.skies: dict[str, Any] = {}  # by settings: what measured_sky.py knows of them
        self.tell = tell or (lambda _: None)
        self._export_image = export_image
        self._cancelled = cancelled
        self._next_check = 0.0
        self._image_index: dict[str, int] = {}
        self._texture_index: dict[tuple[int, str, str], int] = {}

    def note(self, text: str) -> None:
        """Tells the user, once, about something that is rendered other than Blender shows it."""
        if text not in self.notes:
            self.notes.append(Note(text, self.owner))

    def texture(self, image: Any, interpolation: str = "Linear", extension: str = "REPEAT") -> int:
        """The index of a texture that looks `image`, one of image.py's, up as an Image Texture node with these settings does.

        How the pixels are decoded follows from the image's own colour space, as in Blender, not from what they are used for.
        """
        key = image.name_full
        if key not in self._image_index:
            self.images.append(self._export_image(image))
            self._image_index[key] = len(self.images) - 1
        texture = TextureData(self._image_index[key], WRAPS[extension], FILTERS[interpolation])
        texture_key = (texture.image, texture.wrap, texture.filter)
        if texture_key not in self._texture_index:
            self._texture_index[texture_key] = len(self.textures)
            self.textures.append(texture)
        return self._texture_index[texture_key]

    def check_finite(self, data: Any, owner: str) -> None:
        """ExportError where a number of `data`, one of model.py's, is none that can be rendered."""
        wrong = not_finite(data)
        if wrong is not None:
            raise ExportError(f"{owner}: its {wrong} is not a finite number; correct it")

    def check_cancelled(self) -> None:
        """Cheap enough to be called for every object; asks at most ten times a second."""
        now = time.monotonic()
        if self._cancelled is not None and now >= self._next_check:
            self._next_check = now + 0.1
            if self._cancelled():
                raise ExportCancelled
