# SPDX-License-Identifier: GPL-3.0-or-later
"""Exposure, transparency and filters of the film."""

import bpy
from stage import ball, box, diffuse, scene, stage


def things():
    stage()
    box(diffuse((0.8, 0.4, 0.2)), location=(-1.2, 0, 0.8), scale=(0.8, 0.8, 0.8))
    ball(location=(1.3, 0, 0.9), radius=0.9)
    bpy.context.scene.camera.data.lens = 22  # the sky is in the picture
    return bpy.context.scene


def filtered(kind, width=1.5):
    made = things()
    made.cycles.pixel_filter_type, made.cycles.filter_width = kind, width
    made.wardmis.filter_type, made.wardmis.filter_width = kind.lower().replace("_", "-"), width


@scene
def box_filter():
    filtered("BOX")


@scene
def gaussian_filter():
    filtered("GAUSSIAN")


@scene
def wide_filter():
    filtered("BLACKMAN_HARRIS", 6)


@scene
def exposure():
    made = things()
    made.cycles.film_exposure = made.wardmis.film_exposure = 2.5


@scene
def transparent():
    things().render.film_transparent = True


@scene
def view_transform():
    """An image file of linear numbers does not see the view's transform nor its exposure."""
    made = things()
    made.view_settings.exposure, made.view_settings.gamma = 1.0, 1.5
