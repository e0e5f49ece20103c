# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees -> programs: straight lists of operations that the renderer runs at every hit (docs/scene-format.md, "Programs").

builder.py   operations as data: checked, folded, each once        signatures.py, folds.py   what operations take, and compute of constants
reader.py    what an input socket receives, as a value             inputs, colors, vectors, textures, patterns   one function for each node
closures.py  shaders -> weighted closures                          surface.py   closures -> the short form, or a list of closures
"""
