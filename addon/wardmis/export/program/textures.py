# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures of images."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ..image import MISSING, Picture
from ..texture import picture
from ..tree import NodeUse
from .builder import Value
from .patterns import coordinates
from .reader import Reader

# what is done to the colours before they are filtered, and whether they are divided by alpha after that
ALPHA = {
    "kept": ("kept", False),
    "multiplied": ("multiplied", False),
    "divided": ("kept", True),
    "restored": ("multiplied", True),
    "ignored": ("ignored", False),
}


def _image(use: NodeUse, output: Any, p: Reader) -> Value:
    node = use.node
    found = picture(use, p.is_light)
    if found is None:
        return _missing(output, p.is_light)
    parameters = _texture(use, found, node.extension)
    vector = coordinates(use, p, "uv")
    alpha = "-alpha" if output.name == "Alpha" else ""
    if node.projection == "BOX":
        return p(f"image-box{alpha}", vector, p("object-normal"), blend=node.projection_blend, **parameters)
    projection = {} if node.projection == "FLAT" else {"projection": node.projection.lower()}
    return p(f"image{alpha}", vector, **projection, **parameters)


def _environment(use: NodeUse, output: Any, p: Reader) -> Value:
    found = picture(use, p.is_light)
    if found is None:
        return _missing(output, p.is_light)
    projection = {} if use.node.projection == "EQUIRECTANGULAR" else {"projection": "mirror-ball"}
    alpha = "-alpha" if output.name == "Alpha" else ""
    parameters = _texture(use, found, "REPEAT")
    return p(f"environment{alpha}", coordinates(use, p, "position"), **projection, **parameters)


def _texture(use: NodeUse, found: Picture, extension: str) -> dict[str, Any]:
    alpha, unassociate = ALPHA[found.alpha]
    context = use.owner.context
    shown = replace(found, alpha=alpha)
    index = context.texture(shown, use.node.interpolation, extension)
    return {"texture": index} | ({"unassociate": True} if unassociate else {})


UNKNOWN_LIGHT = (0.5, 0.5, 0.5)  # whose image cannot be shown


def _missing(output: Any, is_light: bool) -> Value:
    return 1.0 if output.name == "Alpha" else UNKNOWN_LIGHT if is_light else MISSING


NODES = {"TexImage": _image, "TexEnvironment": _environment}
