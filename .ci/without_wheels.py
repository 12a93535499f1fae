# SPDX-License-Identifier: GPL-3.0-or-later
"""`without_wheels.py ZIP TARGET`: the extension's zip for a Blender with a Python that no bundled wheel is for.

Debian builds Blender with a Python of its own, which may be newer than that of Blender's builds; scipy is Debian's
there.
"""

import re
import sys
import zipfile

MANIFEST = "blender_manifest.toml"


def main(source, target):
    """Copy a zip without its wheels, and without the manifest's word of them."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            if name.endswith(".whl"):
                continue
            content = old.read(name)
            if name == MANIFEST:
                content, count = re.subn(rb"^wheels = \[[^\]]*\]", b"", content, flags=re.MULTILINE)
                if not count:
                    sys.exit(f"error: {source}: its manifest has no list of wheels")
            new.writestr(name, content)


if __name__ == "__main__":
    main(*sys.argv[1:])
