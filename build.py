# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the extension with nothing but Python 3.11 and pip: one zip per platform in dist/.

    python3 build.py            fetch the wheels, check the manifest, build the zips
    python3 build.py --wheels   fetch the wheels only (a Blender without the extension needs them for run.py)

The zips are what `blender -c extension build --split-platforms` makes; a test compares the two.
"""

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from fnmatch import fnmatchcase
from pathlib import Path

ROOT = Path(__file__).resolve().parent
MANIFEST = "blender_manifest.toml"

# The wheels as published, so that a changed one is noticed.
SHA256 = {
    "scipy-1.15.3-cp311-cp311-manylinux_2_17_x86_64.manylinux2014_x86_64.whl": (
        "39cb9c62e471b1bb3750066ecc3a3f3052b37751c7c3dfd0fd7e48900ed52982"
    ),
    "scipy-1.15.3-cp311-cp311-win_amd64.whl": "ae48a786a28412d744c62fd7816a4118ef97e5be0bee968ce8f0a2fba7acf3bb",
    "scipy-1.15.3-cp311-cp311-macosx_12_0_arm64.whl": (
        "34716e281f181a02341ddeaad584205bd2fd3c242063bd3423d61ac259ca7eba"
    ),
    "scipy-1.15.3-cp311-cp311-macosx_10_13_x86_64.whl": (
        "993439ce220d25e3696d1b23b233dd010169b62f6456488567e830654ee37a6b"
    ),
    "scipy-1.15.3-cp313-cp313-manylinux_2_17_x86_64.manylinux2014_x86_64.whl": (
        "c9deabd6d547aee2c9a81dee6cc96c6d7e9a9b1953f74850c179f91fdc729cb7"
    ),
    "scipy-1.15.3-cp313-cp313-win_amd64.whl": "b90ab29d0c37ec9bf55424c064312930ca5f4bde15ee8619ee44e69319aab163",
    "scipy-1.15.3-cp313-cp313-macosx_12_0_arm64.whl": (
        "7e11270a000969409d37ed399585ee530b9ef6aa99d50c019de4cb01e8e54e62"
    ),
    "scipy-1.15.3-cp313-cp313-macosx_10_13_x86_64.whl": (
        "2c620736bcc334782e24d173c0fdbb7590a0a436d2fdf39310a8902505008759"
    ),
    "ezdxf-1.4.5-py3-none-any.whl": "70a79ec7d40990f60453e3c87ffe9f668907ee061cf6f4c0a3794d032ec2b40e",
    "fonttools-4.68.0-py3-none-any.whl": "d76f8fdcb6936f5e1045a0c9dd721a4bf11112e60d1e243bfa1d39f06a8b3104",
    "pyparsing-3.3.3-py3-none-any.whl": "ece8c00a69cf01b45d0b1dedabb469c90d8caf996d4fda40f147627a122849a4",
    "typing_extensions-4.16.0-py3-none-any.whl": ("481caa481374e813c1b176ada14e97f1f67a4539ce9cfeb3f350d78d6370c2e8"),
}

# Blender's platform -> how the last part of a wheel's name begins and ends. "any" is for all.
PLATFORMS = {
    "linux-x64": ("manylinux", "x86_64"),
    "windows-x64": ("win", "amd64"),
    "macos-arm64": ("macosx", "arm64"),
    "macos-x64": ("macosx", "x86_64"),
}


class BuildError(Exception):
    """What is wrong and what to do, in one line."""


def main(argv=None):
    """Build; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wheels", action="store_true", help="fetch the wheels only")
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="folder of the zips (default: dist)")
    options = parser.parse_args(argv)
    try:
        manifest = read_manifest(ROOT / MANIFEST)
        for path in manifest["wheels"]:
            fetch(ROOT / path)
        if not options.wheels:
            options.out.mkdir(exist_ok=True)
            for platform in manifest["platforms"]:
                print(build(manifest, platform, options.out))
    except BuildError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


def read_manifest(path):
    """The manifest, checked by the rules of Blender's extensions site that concern this one."""
    with open(path, "rb") as file:
        manifest = tomllib.load(file)

    def need(held, message):
        if not held:
            raise BuildError(f"{path.name}: {message}")

    for key in ("schema_version", "id", "version", "name", "tagline", "maintainer", "type", "license"):
        need(isinstance(manifest.get(key), str | list) and manifest[key], f"{key} is missing")
    need(re.fullmatch(r"[a-z]\w*", manifest["id"]), "id must be a Python name")
    need(re.fullmatch(r"\d+\.\d+\.\d+(-[\w.]+)?", manifest["version"]), "version must be like 1.2.3")
    need(re.fullmatch(r"\d+\.\d+\.\d+", manifest.get("blender_version_min", "")), "blender_version_min must be x.y.z")
    texts = {"tagline": manifest["tagline"], **{f"permissions.{k}": v for k, v in manifest["permissions"].items()}}
    for key, text in texts.items():
        need(len(text) <= 64 and text[-1].isalnum(), f"{key} must have up to 64 letters and no stop at its end")
    need("blender" not in manifest["name"].lower(), "name must not contain Blender")
    need(set(manifest["platforms"]) <= set(PLATFORMS), f"platforms must be of {', '.join(PLATFORMS)}")
    names = {Path(wheel).name for wheel in manifest["wheels"]}
    need(names == set(SHA256), "wheels must be those in the table of build.py")
    for platform in manifest["platforms"]:
        own = [wheel for wheel in wheels_for(manifest, platform) if not wheel.endswith("-any.whl")]
        need(own, f"no wheel for {platform}")
    return manifest


def wheels_for(manifest, platform):
    """The manifest's wheels that are for a platform."""
    begin, end = PLATFORMS[platform]
    tags = {wheel: Path(wheel).stem.split("-")[-1] for wheel in manifest["wheels"]}
    return [wheel for wheel, tag in tags.items() if tag == "any" or (tag.startswith(begin) and tag.endswith(end))]


def fetch(path):
    """Have a wheel in place, with the hash of the table."""
    if path.exists() and digest(path) == SHA256[path.name]:
        return
    name, version, python, abi, platform = path.stem.split("-")  # python is like cp311, or py3
    print(f"fetching {path.name}")
    with tempfile.TemporaryDirectory() as folder:
        command = [
            *(sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"),
            *("--only-binary=:all:", "--implementation", python[:2], "--python-version", python[2:].ljust(3, "1")),
            *("--abi", abi, "--platform", platform.split(".")[0], "--dest", folder, f"{name}=={version}"),
        ]
        if subprocess.run(command).returncode:
            raise BuildError(f"pip could not fetch {path.name}; is there a network?")
        got = Path(folder) / path.name
        if not got.exists():
            raise BuildError(f"pip fetched {', '.join(os.listdir(folder))}, not {path.name}")
        if digest(got) != SHA256[path.name]:
            raise BuildError(f"{path.name} has not the hash in build.py; it was changed on its way")
        path.parent.mkdir(exist_ok=True)
        part = path.with_suffix(".part")
        part.write_bytes(got.read_bytes())
        part.replace(path)


def digest(path):
    """The SHA-256 of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def sources(manifest):
    """Paths of what goes into every zip, relative to the root, sorted; the manifest and the wheels are not among it."""
    patterns = manifest["build"]["paths_exclude_pattern"]
    found = []
    for folder, folders, files in os.walk(ROOT):
        base = Path(folder).relative_to(ROOT).as_posix()
        base = "" if base == "." else base + "/"
        folders[:] = [name for name in folders if not excluded(base + name + "/", patterns)]
        found += [base + name for name in files if not excluded(base + name, patterns)]
    return sorted(set(found) - {MANIFEST})


def excluded(path, patterns):
    """Whether a path (a folder's ends with /) fits a pattern: those with a leading / hold at the root only."""
    name = path.rstrip("/").rpartition("/")[2] + ("/" if path.endswith("/") else "")
    return any(path == pattern[1:] if pattern.startswith("/") else fnmatchcase(name, pattern) for pattern in patterns)


def build(manifest, platform, folder):
    """Write the zip of one platform; its path."""
    wheels = wheels_for(manifest, platform)
    generated = (
        "\n\n# BEGIN GENERATED CONTENT.\n# This must not be included in source manifests.\n[build.generated]\n"
        f"platforms = {json.dumps([platform])}\nwheels = {json.dumps(wheels)}\n# END GENERATED CONTENT.\n"
    )
    out = folder / f"{manifest['id']}-{manifest['version']}-{platform.replace('-', '_')}.zip"
    part = out.with_suffix(".part")
    with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        _add(archive, MANIFEST, (ROOT / MANIFEST).read_bytes() + generated.encode())
        for path in wheels:
            _add(archive, path.removeprefix("./"), (ROOT / path).read_bytes(), zipfile.ZIP_STORED)
        for path in sources(manifest):
            _add(archive, path, (ROOT / path).read_bytes())
    part.replace(out)
    return out


def _add(archive, name, data, method=zipfile.ZIP_DEFLATED):
    entry = zipfile.ZipInfo(name)  # without the time of day: the same sources give the same zip
    entry.external_attr = 0o644 << 16
    archive.writestr(entry, data, method)


if __name__ == "__main__":
    sys.exit(main())
