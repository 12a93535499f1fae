# SPDX-License-Identifier: GPL-3.0-or-later
"""The zips of build.py against those of Blender's own builder, and what they must not hold."""

import importlib.util
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
ROOMS = {"core", "fcn_addon", "operators", "ui", "wheels"}


@pytest.fixture(scope="module")
def builder():
    spec = importlib.util.spec_from_file_location("fcn_build", ROOT / "build.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def manifest(builder):
    return builder.read_manifest(ROOT / "blender_manifest.toml")


@pytest.fixture(scope="module")
def zips(builder, manifest, tmp_path_factory):
    """One zip per platform."""
    folder = tmp_path_factory.mktemp("dist")
    missing = [ROOT / w for w in manifest["wheels"] if not (ROOT / w).exists()]
    if missing:
        pytest.skip("the wheels are not here; `python3 build.py --wheels` fetches them")
    return {p: builder.build(manifest, p, folder) for p in manifest["platforms"]}


def blender_ext():
    """Blender's own tool, from the bpy module."""
    spec = importlib.util.find_spec("bpy")
    if spec is None:
        pytest.skip("needs Blender as a module")
    return next(Path(spec.origin).parent.rglob("bl_pkg/cli/blender_ext.py"))


def test_the_versions_agree(manifest):
    with open(ROOT / "pyproject.toml", "rb") as file:
        assert tomllib.load(file)["project"]["version"] == manifest["version"]
    assert f"## {manifest['version']}" in (ROOT / "CHANGELOG.md").read_text()


def test_every_platform_has_a_wheel_for_each_python(builder, manifest):
    for platform in manifest["platforms"]:
        wheels = [Path(w).name.split("-") for w in builder.wheels_for(manifest, platform)]
        assert sorted(w[2] for w in wheels if w[0] == "scipy") == ["cp311", "cp313"]
        assert {w[0] for w in wheels if w[2] == "py3"} == {"ezdxf", "fonttools", "pyparsing", "typing_extensions"}


def test_nothing_but_the_extension_is_in_a_zip(zips):
    for path in zips.values():
        names = zipfile.ZipFile(path).namelist()
        top = {*ROOMS, "__init__.py", "blender_manifest.toml", "LICENSE", "docs"}
        assert {n.partition("/")[0] for n in names} == top
        manual = {n for n in names if n.startswith("docs/") and not n.endswith("/")}  # of the other pages none
        assert {n for n in manual if not n.startswith("docs/pictures/")} == {"docs/blender.md"} and len(manual) > 5
        assert not [n for n in names if "__pycache__" in n or "/." in n or n.endswith((".pyc", ".part"))]


def test_a_zip_holds_its_own_wheels_only(zips, builder, manifest):
    for platform, path in zips.items():
        archive = zipfile.ZipFile(path)
        inside = tomllib.loads(archive.read("blender_manifest.toml").decode())["build"]["generated"]
        assert inside["platforms"] == [platform]
        assert inside["wheels"] == builder.wheels_for(manifest, platform)
        held = {"./" + n for n in archive.namelist() if n.endswith(".whl")}
        assert held == set(inside["wheels"])


def test_blender_builds_the_same(zips, tmp_path):
    tool = blender_ext()
    subprocess.run(
        [sys.executable, tool, "build", "--source-dir", ROOT, "--output-dir", tmp_path, "--split-platforms"],
        check=True, capture_output=True,
    )  # fmt: skip
    assert {p.name for p in tmp_path.iterdir()} == {p.name for p in zips.values()}
    for ours in zips.values():
        a, b = zipfile.ZipFile(ours), zipfile.ZipFile(tmp_path / ours.name)
        assert sorted(a.namelist()) == sorted(b.namelist())
        assert all(a.getinfo(n).CRC == b.getinfo(n).CRC for n in a.namelist() if n != "blender_manifest.toml")
        tables = [tomllib.loads(z.read("blender_manifest.toml").decode()) for z in (a, b)]
        assert tables[0] == tables[1]


def test_blender_finds_nothing_wrong_with_a_zip(zips):
    for path in zips.values():
        done = subprocess.run([sys.executable, blender_ext(), "validate", path], capture_output=True, text=True)
        assert done.returncode == 0, done.stdout


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('version = "0.1.0"', 'version = "1"', "version must be like"),
        ("from what recurs in them", "from what recurs in them.", "tagline"),
        ("Feature Curve Co-Completion", "Blender Curves", "must not contain Blender"),
        ("cp313-cp313-win_amd64", "cp312-cp312-win_amd64", "wheels must be those"),
        ('blender_version_min = "4.2.0"', "", "blender_version_min"),
    ],
)
def test_a_wrong_manifest_is_refused(builder, tmp_path, old, new, message):
    text = (ROOT / "blender_manifest.toml").read_text()
    assert old in text
    path = tmp_path / "blender_manifest.toml"
    path.write_text(text.replace(old, new))
    with pytest.raises(builder.BuildError, match=message):
        builder.read_manifest(path)


def test_a_wheel_that_was_changed_is_noticed(builder, manifest, tmp_path, monkeypatch):
    """Something else on disk under the wheel's name is fetched anew, and what comes is checked."""
    path = tmp_path / Path(manifest["wheels"][0]).name
    path.write_bytes(b"not a wheel")

    def pip(command):
        (Path(command[command.index("--dest") + 1]) / path.name).write_bytes(b"not the wheel either")
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(builder.subprocess, "run", pip)
    with pytest.raises(builder.BuildError, match="has not the hash"):
        builder.fetch(path)
