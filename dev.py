# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes environments in .venv/ and runs things in them; needs Python 3.11 or 3.13 with venv, and a network once.

python3 dev.py example [facade]     run an example: a scan that is made first, or quick, curves; results go to out/
python3 dev.py test [arguments]     run the tests (arguments go to pytest)
python3 dev.py env EXTRA...         make the environment of these extras of pyproject.toml, print its Python
"""

import hashlib
import os
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent
EXAMPLES = {  # name -> what makes its input, and what completes it
    "scan": (("-m", "examples.make_scan", "out/wall.ply"), ("run.py", "out/wall.ply")),
    "facade": (None, ("run.py", "examples/facade.obj", "--edge-length", "0.02")),
}
RESULTS = {"--curves": ".obj", "--report": ".json", "--figure": ".png"}

# Blender's Python -> the oldest Blender that has it.
BLENDER = {(3, 11): "bpy42", (3, 13): "bpy52"}


def environment(extras):
    """The Python of a virtual environment with these extras; made, or made anew when what they ask for changes."""
    with open(ROOT / "pyproject.toml", "rb") as file:
        known = tomllib.load(file)["project"]["optional-dependencies"]
    for extra in extras:
        if extra not in known:
            sys.exit(f"error: no extra {extra!r}; there are {', '.join(known)}")
    wanted = [requirement for extra in extras for requirement in known[extra]]
    folder = ROOT / ".venv" / "-".join(extras)
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    stamp = folder / "stamp"
    mark = hashlib.sha256(repr((sys.version, wanted)).encode()).hexdigest()
    if not stamp.exists() or stamp.read_text() != mark:
        print(f"making {folder.relative_to(ROOT)}: {', '.join(wanted)}", file=sys.stderr)
        if subprocess.run([sys.executable, "-m", "venv", "--clear", str(folder)], stdout=sys.stderr).returncode:
            sys.exit("error: cannot make a virtual environment; on Debian: apt-get install python3-venv")
        pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        if subprocess.run([*pip, *wanted], stdout=sys.stderr).returncode:
            sys.exit("error: pip could not install them; is there a network?")
        stamp.write_text(mark)
    return str(python)


def example(name):
    """Run an example; the exit code."""
    (ROOT / "out").mkdir(exist_ok=True)
    python = environment(["example"])
    make, complete = EXAMPLES[name]
    if make is not None:
        code = subprocess.run([python, *make], cwd=ROOT).returncode
        if code:
            return code
    results = [word for option, ending in RESULTS.items() for word in (option, f"out/{name}{ending}")]
    return subprocess.run([python, *complete, *results], cwd=ROOT).returncode


def test(arguments):
    """Run the tests on the bpy that fits this Python; the exit code."""
    extra = BLENDER.get(sys.version_info[:2])
    if extra is None:
        sys.exit("error: the tests need Python 3.11 or 3.13, those of Blender; run this file with one of them")
    return subprocess.run([environment([extra, "test"]), "-m", "pytest", *arguments], cwd=ROOT).returncode


def main(arguments):
    """Do what the arguments say; the exit code."""
    match arguments:
        case ["example", *name] if name in ([], *([known] for known in EXAMPLES)):
            return example(*(name or ["scan"]))
        case ["test", *rest]:
            return test(rest)
        case ["env", first, *rest]:
            print(environment([first, *rest]))
            return 0
    print(__doc__.strip(), file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
