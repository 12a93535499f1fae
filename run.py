# SPDX-License-Identifier: GPL-3.0-or-later
"""The program without a window, from the project's folder.

    blender -b --python-exit-code 1 -P run.py -- INPUT [options]
    python run.py INPUT [options]

The second needs numpy and scipy, for .dxf files ezdxf, and for .blend files bpy. `--help` lists the options.
"""

import importlib.util
import os
import shutil
import sys
import sysconfig
import types
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent
PACKAGE = "fcn"
FOR_DXF = ("typing_extensions", "pyparsing", "fontTools", "ezdxf")
WHEELS = {"fontTools": "fonttools"}  # name of a package -> of its wheel, where they differ


def arguments():
    """What follows `--` in Blender, else what follows the script's name."""
    if "--" in sys.argv:
        return sys.argv[sys.argv.index("--") + 1 :]
    return [] if _in_blender() else sys.argv[1:]


def _in_blender():
    """Whether Blender runs this file, rather than a Python."""
    bpy = sys.modules.get("bpy")
    return bpy is not None and bool(bpy.app.binary_path)


def load_package():
    """The project's folder as one package, whatever it is called, so that its relative imports work."""
    if PACKAGE not in sys.modules:
        spec = importlib.util.spec_from_file_location(
            PACKAGE, ROOT / "__init__.py", submodule_search_locations=[str(ROOT)]
        )
        module = importlib.util.module_from_spec(spec)
        sys.modules[PACKAGE] = module
        spec.loader.exec_module(module)
    return PACKAGE


def provide(name):
    """Make a library importable; False where it is nowhere."""
    if importlib.util.find_spec(name):
        return True
    for folder in _site_folders():
        if (folder / name).is_dir():
            sys.path.append(str(folder))
            return True
    for folder in (*_extension_folders(), ROOT):
        wheel = next((w for w in sorted(folder.glob(f"wheels/{WHEELS.get(name, name)}-*.whl")) if fits(w.name)), None)
        if wheel is not None:
            sys.path.append(str(_unpack(wheel)))
            return True
    return False


def _extensions():
    if not _in_blender():
        return None
    import bpy

    return Path(bpy.utils.user_resource("EXTENSIONS"))


def _site_folders():
    """Where Blender puts the wheels of the extensions it has enabled."""
    base = _extensions()
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    return [] if base is None else [base / ".local" / "lib" / version / "site-packages"]


def _extension_folders():
    """Where this extension may be installed."""
    base = _extensions()
    return [] if base is None else sorted(base.glob("*/fcn_addon"))


def fits(wheel):
    """Whether the wheel of this file name is for this Python and this machine."""
    _, _, python, _, platforms = wheel.removesuffix(".whl").split("-")[-5:]
    system, machine = sysconfig.get_platform().split("-")[0], sysconfig.get_platform().split("-")[-1]
    word = {"linux": "manylinux", "macosx": "macosx", "win": "win"}.get(system, system)
    if platforms == "any":
        return python == "py3"
    return (
        python == f"cp{sys.version_info.major}{sys.version_info.minor}"
        and platforms.startswith(word)
        and platforms.endswith(machine)
    )


def _unpack(wheel):
    """The wheel's content, in a folder beside the wheels of the project; unpacked once."""
    target = ROOT / "wheels" / wheel.stem
    if not target.is_dir():
        part = target.with_name(f".{wheel.stem}.{os.getpid()}")
        try:
            with zipfile.ZipFile(wheel) as archive:
                archive.extractall(part)
            os.replace(part, target)
        except OSError:  # another run may have been first
            if not target.is_dir():
                raise
        finally:
            shutil.rmtree(part, ignore_errors=True)
    return target


def help_alone():
    """Print the help where numpy is missing: only the modules that hold the arguments are loaded, not their rooms."""
    package = load_package()
    for room in ("core", "core.detection"):
        bare = sys.modules[f"{package}.{room}"] = types.ModuleType(f"{package}.{room}")
        bare.__path__ = [str(ROOT.joinpath(*room.split(".")))]
    importlib.import_module(f"{package}.fcn_addon.command.arguments").parser("run.py").print_help()
    return 0


def main():
    """Run and return the exit code."""
    if not importlib.util.find_spec("numpy") and {"-h", "--help"} & set(arguments()):
        return help_alone()
    for name, remedy in (("numpy", "`pip install numpy scipy` gets both"),):
        if not importlib.util.find_spec(name):
            print(f"error: {name} is missing: {remedy}", file=sys.stderr)
            return 2
    if not provide("scipy"):
        print(
            "error: scipy is missing: `python3 build.py --wheels` fetches it for Blender,"
            " `pip install scipy` for this Python",
            file=sys.stderr,
        )
        return 2
    for name in FOR_DXF:  # without them all but DXF works
        provide(name)
    package = load_package()
    command_line = importlib.import_module(f"{package}.fcn_addon.command.run")
    return command_line.main(arguments(), prog="run.py")


if __name__ == "__main__":
    sys.exit(main())
