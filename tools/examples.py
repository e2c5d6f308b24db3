#!/usr/bin/env python3
"""Runs the commands of docs/examples/README.md and draws its pictures again.

tools/examples.py PROGRAM [--quick] [--only WORD] [--data FOLDER] [--judge SCORE.PY]

--quick: at a low resolution, and the pictures are thrown away: a check that every command works and that every mesh it
makes is valid by PROGRAM's own `inspect --fail-on any`. --only: the sections whose title has the word. --judge: also let
another program, called as `SCORE.PY MESH MESH --json --samples N`, say whether every mesh is valid.
"""

import argparse
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "examples" / "README.md"
QUICK = {"--resolution": "24"}


def sections(page):
    for part in re.split(r"^## ", page.read_text(), flags=re.M)[1:]:
        title = part.splitlines()[0]
        commands = []
        for block in re.findall(r"```sh\n(.*?)```", part, flags=re.S):
            commands += [shlex.split(line) for line in block.splitlines() if line.strip()]
        yield title, commands


def quick(words):
    """The same command with large voxels."""
    words = list(words)
    for k, word in enumerate(words[:-1]):
        if word in QUICK:
            words[k + 1] = QUICK[word]
        elif word == "--voxel":
            words[k + 1] = str(5 * float(words[k + 1]))
        elif word in ("--width", "--height"):
            words[k + 1] = "96"
    return words


def valid(program, path, judge):
    made = subprocess.run([program, "inspect", path, "--fail-on", "any", "-q"], stdout=subprocess.DEVNULL)
    if made.returncode != 0:
        return False
    if judge is None:
        return True
    told = subprocess.run([sys.executable, judge, path, path, "--json", "--samples", "1000"], capture_output=True, text=True)
    return told.returncode == 0 and json.loads(told.stdout)["validity"]["valid"] is True


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--data", default=str(ROOT.parent / "shared" / "data"))
    parser.add_argument("--judge")
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    judge = options.judge and os.path.abspath(options.judge)
    failed = []
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(os.path.abspath(options.data), os.path.join(folder, "data"))
        os.symlink(ROOT / "testdata", os.path.join(folder, "testdata"))
        for title, commands in sections(PAGE):
            if options.only.lower() not in title.lower():
                continue
            started = time.time()
            for words in commands:
                words = quick(words) if options.quick else words
                done = subprocess.run([program, *words[1:], "-q"], cwd=folder)
                if done.returncode != 0:
                    failed.append(f"{title}: exit {done.returncode} of {shlex.join(words)}")
            meshes = sorted(Path(folder).glob("*.ply"))
            failed += [f"{title}: {mesh.name} is not valid" for mesh in meshes if not valid(program, str(mesh), judge)]
            for mesh in meshes:
                mesh.unlink()
            for picture in Path(folder).glob("*.png"):
                if not options.quick:
                    shutil.copy(picture, PAGE.parent / picture.name)
                picture.unlink()
            print(f"{time.time() - started:8.1f} s  {title}", flush=True)
    sys.exit("\n".join(failed) or 0)


if __name__ == "__main__":
    main()
