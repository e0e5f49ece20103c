# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports a Blender file in the background as a scene for the command `wardmis`:

blender --background FILE.blend --addons wardmis --python blend/export_scene.py -- SCENE.glb"""

import sys

import wardmis

if __name__ == "__main__":
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    if len(arguments) != 1:
        sys.exit(__doc__)
    try:
        wardmis.export_scene(arguments[0])
    except RuntimeError as error:
        sys.exit(f"error: {error}")
