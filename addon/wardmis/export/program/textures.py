# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures of images."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ... import compat
from ..image import MISSING, Picture, picture_of
from ..tree import NodeUse
from .builder import Value
from .folding import Folding
from .patterns import coordinates
from .reader import Reader


def _image(use: NodeUse, output: Any, p: Reader) -> Value:
    node = use.node
    found = _picture(use)
    if found is None:
        return _missing(output)
    tiled = node.image.source == "TILED" and node.projection != "BOX"
    parameters = _texture(use, found, node.extension, tiled)
    vector = coordinates(use, p, "uv")
    alpha = "-alpha" if output.name == "Alpha" else ""
    if node.projection == "BOX":
        _note_first_tile(use)
        return p(f"image-box{alpha}", vector, p("object-normal"), blend=node.projection_blend, **parameters)
    projection = {} if node.projection == "FLAT" else {"projection": node.projection.lower()}
    return p(f"image{alpha}", vector, **projection, **parameters)


def _environment(use: NodeUse, output: Any, p: Reader) -> Value:
    found = _picture(use)
    if found is None:
        return _missing(output)
    projection = {} if use.node.projection == "EQUIRECTANGULAR" else {"projection": "mirror-ball"}
    alpha = "-alpha" if output.name == "Alpha" else ""
    _note_first_tile(use)
    parameters = _texture(use, found, "REPEAT")
    return p(f"environment{alpha}", coordinates(use, p, "position"), **projection, **parameters)


def _picture(use: NodeUse) -> Picture | None:
    """None, and a note, where there is nothing to show."""
    node = use.node
    if node.image is None:
        use.note("has no image; magenta is shown instead")
        return None
    found = picture_of(node.image, _shows_alpha(use), node.image_user, use.owner.context.frame)
    reason = found.missing()
    if reason is not None:
        use.note(f"needs an image; {reason}; magenta is shown instead")
        is_clipped = compat.MISSING_IMAGES_ARE_CLIPPED and getattr(node, "extension", "") == "CLIP"
        return found if is_clipped and node.image.source != "TILED" else None
    for deviation in found.deviations():
        use.note(f"shows {deviation}")
    return found


def _shows_alpha(use: NodeUse) -> bool:
    """Whether Cycles finds the node's Alpha used; of an environment it does not ask."""
    if use.node.bl_idname != "ShaderNodeTexImage" or use.node.image.alpha_mode not in {"STRAIGHT", "PREMUL"}:
        return False
    tree = (use.entered[0] if use.entered else use).node.id_data
    foldings, key = use.owner.context.foldings, (use.owner.place, tree.as_pointer())
    if key not in foldings:
        foldings[key] = Folding(use.owner, tree)
    return bool(foldings[key].shows_alpha(use))


def _texture(use: NodeUse, found: Picture, extension: str, tiled: bool = False) -> dict[str, Any]:
    def index(picture: Picture) -> int:
        return use.owner.context.texture(picture, use.node.interpolation, extension)

    texture: Any = index(found) if not tiled else tuple((tile.tile, index(tile)) for tile in _tiles(use, found))
    return {"texture": texture} | ({"unassociate": True} if found.divided else {})


def _tiles(use: NodeUse, found: Picture) -> list[Picture]:
    """Those that the image has; what is elsewhere is magenta, as in Cycles."""
    tiles = [replace(found, tile=tile.number) for tile in found.image.tiles]
    for tile in tiles:
        reason = tile.missing()
        if reason is not None:
            use.note(f"has a tile that cannot be shown; {reason}; magenta is shown instead")
    return tiles


def _note_first_tile(use: NodeUse) -> None:
    image = use.node.image
    if image.source == "TILED" and len(image.tiles) > 1:
        use.note(f"shows tile {image.tiles[0].number} of image '{image.name}' alone, as in Cycles")


def _missing(output: Any) -> Value:
    return 1.0 if output.name == "Alpha" else MISSING


NODES = {"TexImage": _image, "TexEnvironment": _environment}
