# SPDX-License-Identifier: GPL-3.0-or-later
"""The built zip, installed from file into a fresh Blender: enabled, with its own scipy, and taken out again."""

import importlib.util
import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
PLATFORM = {"linux-x86_64": "linux-x64", "win-amd64": "windows-x64"}

PROGRAM = """
import bpy, sys
import addon_utils  # found once bpy is there
from pathlib import Path
# Blender as a module starts without the extensions of the user; the add-on that installs them is needed.
addon_utils.enable("bl_pkg", default_set=True)
done = bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True)
assert done == {"FINISHED"}, done
name = "bl_ext.user_default.fcn_addon"
try:
    assert addon_utils.check(name) == (True, True), addon_utils.check(name)
    registration = sys.modules[name + ".fcn_addon.registration"]
    assert len(registration._registered) == len(registration.ROOMS)
    base = Path(bpy.utils.user_resource("EXTENSIONS"))
    python = f"python{sys.version_info.major}.{sys.version_info.minor}"
    scipy = list(base.glob(f".local/lib/{python}/site-packages/scipy")) or list(base.glob(".local/**/scipy"))
    assert scipy, "no scipy was installed"
    assert any(Path(p) in scipy[0].parents for p in sys.path), "scipy is not on the path"
finally:
    addon_utils.disable(name, default_set=True)
assert registration._registered == []
print("installed")
"""


@pytest.fixture
def archive(tmp_path):
    """The zip for this machine."""
    spec = importlib.util.spec_from_file_location("fcn_build", ROOT / "build.py")
    builder = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(builder)
    manifest = builder.read_manifest(ROOT / "blender_manifest.toml")
    tag = sysconfig.get_platform()
    platform = PLATFORM.get(tag, "macos-arm64" if tag.endswith("arm64") else "macos-x64")
    if not all((ROOT / wheel).exists() for wheel in builder.wheels_for(manifest, platform)):
        pytest.skip("the wheels are not here; `python3 build.py --wheels` fetches them")
    return builder.build(manifest, platform, tmp_path)


def test_it_installs_from_file_into_a_fresh_blender(archive, tmp_path):
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "fresh")}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(archive)], env=environment, capture_output=True, text=True, timeout=200
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.rstrip().endswith("installed")
