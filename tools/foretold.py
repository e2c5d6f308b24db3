#!/usr/bin/env python3
"""Whether repairs do what `inspect` foretells.

    python3 tools/foretold.py target/release/meshwright FOLDER

For every mesh of at most 5 MB in a folder that is no solid: runs the first command of `next` as it is printed, through a shell, and compares which way the repair went, and how many holes
were closed by lids and from voxels, with what `inspect` said.
"""

import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

MOST_BYTES = 5_000_000


def inspected(program, folder, name):
    ran = subprocess.run([program, "inspect", name, "--json", "-q"], cwd=folder, capture_output=True, text=True)
    return json.loads(ran.stdout)["result"]


def foretold(result):
    """Holes closed by lids and from voxels."""
    lids = voxels = 0
    for entry in result.get("worst", []):
        text = entry["repair"]
        lids += sum(int(n) for n in re.findall(r"(\d+) closed by lids", text))
        voxels += sum(int(n) for n in re.findall(r"(\d+) closed from voxels", text))
        if text.startswith("closed: "):
            voxels += text.startswith("closed: from voxels")
            lids += not text.startswith("closed: from voxels")
    return lids, voxels


def done(pipeline):
    way = "voxels" if pipeline["lattice"] else "exact" if pipeline["exact"] else "as-it-is"
    closed = [hole["closed_by"] for hole in pipeline["holes"]]
    count = lambda what: sum(isinstance(by, dict) and what in by for by in closed)
    return way, (count("lid"), count("voxels"))


def main():
    program, meshes = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    solids = ways = holes = commands = 0
    for mesh in sorted(path for path in meshes.iterdir() if path.stat().st_size <= MOST_BYTES):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy(mesh, folder)
            result = inspected(program, folder, mesh.name)
            command = result["next"][0].get("command")
            if not command:
                continue
            line = command.replace("meshwright", f"'{program}'", 1) + " --report run.json"
            ran = subprocess.run(["sh", "-c", line], cwd=folder, capture_output=True, text=True)
            report = json.loads((Path(folder) / "run.json").read_text())
            way, closed = done(report["result"]["pipeline"])
            said = result["detail"]["way"], foretold(result)
            commands, solids = commands + 1, solids + (ran.returncode == 0)
            ways, holes = ways + (said[0] == way), holes + (said[1] == closed)
            print(f"{command}: exit {ran.returncode}; foretold {said[0]} {said[1]}, done {way} {closed}")
    print(f"{commands} commands, {solids} with exit 0; the way of {ways} and the holes of {holes} as foretold")


if __name__ == "__main__":
    main()
