# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a Blender file in the background with other settings than its own, into a multi-layer EXR:

blender --background FILE.blend --python blend/render_with.py -- OUT.exr render.engine=WARDMIS wardmis.samples=64 ...

Each setting is a property of the scene and its value, as Blender's Python tooltips name it; a member of a collection goes by
its name: view_layers.ViewLayer.wardmis.use_pass_variance=True"""

import sys

import bpy


def assign(scene: bpy.types.Scene, setting: str) -> None:
    path, _, text = setting.partition("=")
    *owners, name = path.split(".")
    target = scene
    for owner in owners:
        members = isinstance(target, bpy.types.bpy_prop_collection)
        target = target[owner] if members else getattr(target, owner)
    old = getattr(target, name)
    value = text == "True" if isinstance(old, bool) else type(old)(text)
    setattr(target, name, value)


def render(out: str, settings: list[str]) -> None:
    scene = bpy.context.scene
    for setting in settings:
        try:
            assign(scene, setting)
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            sys.exit(f"render_with.py: '{setting}': {error}")
    image = scene.render.image_settings
    if hasattr(image, "media_type"):  # Blender 5
        image.media_type = "MULTI_LAYER_IMAGE"
    image.file_format = "OPEN_EXR_MULTILAYER"
    image.color_depth = "32"
    scene.render.use_file_extension = False
    scene.render.filepath = out
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    if not arguments:
        sys.exit(__doc__)
    render(arguments[0], arguments[1:])
