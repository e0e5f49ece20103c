# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares configurations of WardMIS, and Cycles, on a Blender file in the background:

blender --background FILE.blend --addons wardmis --python blend/compare.py -- -o DIR [options; --help lists them]"""

import sys

from wardmis.comparison import command_line

if __name__ == "__main__":
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    sys.exit(command_line.main(words, "./dev compare FILE.blend"))
