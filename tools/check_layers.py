# SPDX-License-Identifier: GPL-3.0-or-later
"""The direction of #includes and imports: upper floors know lower ones, never the other way, nor their neighbours."""

import ast
import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

# native/: the floors of the house, the top first.
FLOORS = [
    {"cli"},
    {"report", "study"},
    {"integrate"},
    {"world", "gltf"},
    {"scene"},
    {"program"},
    {"bsdf", "mis", "film", "oiio", "codecs"},
    {"image", "pattern"},
    {"math"},
]
# Libraries that one place alone may know.
LIBRARIES = {
    "embree": ["native/world/embree"],
    "CLI": ["native/cli/"],
    "OpenImageIO": ["native/oiio/"],
}
LIBRARIES |= {library: ["native/codecs/"] for library in ("draco", "meshoptimizer", "webp")}

# Python: Blender's modules, and where they may be imported.
BLENDER = {"bpy", "bpy_extras", "mathutils", "gpu", "bl_ui", "nodeitems_utils"}
WITH_BLENDER = ("addon/", "tests/addon/", "tests/cycles/", "tests/golden/", "blend/", "tools/fibre_table.py")
# These parts of the add-on are plain data: they must work, and be tested, without Blender.
WITHOUT_BLENDER = tuple(f"addon/wardmis/export/{name}.py" for name in ("model", "glb", "target"))

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include\s*(?:"([^"]+)"|<([^>]+)>)', re.MULTILINE)


def floor(folder: str) -> int | None:
    return next((i for i, floor in enumerate(FLOORS) if folder in floor), None)


def include_problems(path: Path, text: str) -> Iterator[str]:
    """`path` is relative to the root: native/FOLDER/..."""
    folder = path.parts[1]
    own = floor(folder)
    if own is None:
        yield f"{path}: folder '{folder}' is on no floor; tools/check_layers.py lists them"
        return
    for match in INCLUDE.finditer(text):
        line = text.count("\n", 0, match.start()) + 1
        quoted, angled = match.groups()
        target = Path(quoted or angled).parts[0]
        if quoted and target != folder:
            below = floor(target)
            if below is None:
                yield f'{path}:{line}: "{quoted}" is on no floor; include from native/, as in "math/vec.h"'
            elif below <= own:
                yield f"{path}:{line}: '{folder}' must not include '{target}': only floors below it"
        for places in [places for library, places in LIBRARIES.items() if angled and target.startswith(library)]:
            if not str(path).startswith(tuple(places)):
                yield f"{path}:{line}: <{angled}> is known in {', '.join(places)} alone"


def imported(tree: ast.AST) -> Iterator[tuple[int, str]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name.split(".")[0]) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            yield node.lineno, node.module.split(".")[0]


def import_problems(path: Path, text: str) -> Iterator[str]:
    allowed = str(path).startswith(WITH_BLENDER) and str(path) not in WITHOUT_BLENDER
    for line, module in imported(ast.parse(text, str(path))):
        if module in BLENDER and not allowed:
            yield f"{path}:{line}: '{module}' must not be imported here: Blender's modules stay in {', '.join(WITH_BLENDER)}"


def problems(root: Path) -> Iterable[str]:
    for path in sorted((root / "native").rglob("*.[ch]*")):
        yield from include_problems(path.relative_to(root), path.read_text())
    for folder in ("addon", "blend", "tests", "tools", "farm"):
        for path in sorted((root / folder).rglob("*.py")):
            yield from import_problems(path.relative_to(root), path.read_text())


def main() -> int:
    found = list(problems(Path(__file__).resolve().parent.parent))
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
