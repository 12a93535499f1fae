# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of docs/ of those of the sessions: `python tests/window/keep_pictures.py FOLDER`. Needs Pillow."""

import sys
from pathlib import Path

from PIL import Image

KEPT = {  # name in docs/pictures -> name of the session's picture, what of it (left, top, right, bottom)
    "install-1": ("install-1-preferences", (0, 0, 1060, 340)),
    "install-2": ("install-2-enabled", (0, 0, 1060, 340)),
    "install-3": ("install-3-panel", (0, 0, 1060, 480)),
    "panel": ("1-panel", (0, 0, 1280, 720)),
    "parameters": ("1-parameters", (765, 80, 1056, 720)),
    "progress": ("2-progress", (380, 28, 1056, 340)),
    "result": ("first-4-result", (0, 0, 1280, 720)),
    "edit": ("first-5-edit", (0, 0, 1280, 720)),
    "components": ("4-view-components", (340, 80, 1056, 720)),
    "templates": ("4-view-templates", (340, 80, 1056, 720)),
    "source": ("7-source", (0, 28, 1056, 720)),
}
COLOURS = 96


def main(folder):
    target = Path(__file__).resolve().parent.parent.parent / "docs" / "pictures"
    target.mkdir(exist_ok=True)
    for name, (source, box) in KEPT.items():
        picture = Image.open(Path(folder) / f"{source}.png").convert("RGB").crop(box)
        path = target / f"{name}.png"
        picture.quantize(COLOURS, dither=Image.Dither.NONE).save(path, optimize=True)
        print(path.name, path.stat().st_size // 1024, "KB")


if __name__ == "__main__":
    main(sys.argv[1])
