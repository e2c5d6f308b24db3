#!/usr/bin/env python3
"""How time and memory of a run grow with the resolution: seconds of each stage, the peak, and the exponents.

tools/growth.py PROGRAM MESH [--resolutions 256,512,1024] [--verb "repair --method voxel"] [--runs 3]

Least of --runs runs. The exponent of a row is that of a power law from the first to the last resolution: 2 where time follows
the surface, 3 where it follows the volume. Stages of less than 20 ms at the last resolution have none.
"""

import argparse
import json
import math
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

LEAST = 0.02


def stages(report):
    """Seconds of each stage, in the order in which they came."""
    found = {}

    def look(part):
        if isinstance(part, dict):
            for key, value in part.items():
                if key == "stages" and isinstance(value, list):
                    for stage in value:
                        found[stage["stage"]] = found.get(stage["stage"], 0.0) + stage["seconds"]
                else:
                    look(value)
        elif isinstance(part, list):
            for value in part:
                look(value)

    look(report)
    return found


def run(program, verb, mesh, resolution, folder):
    report = folder / "report.json"
    words = [program, *shlex.split(verb), mesh, "--resolution", str(resolution), "-o", str(folder / "out.ply"), "--force"]
    done = subprocess.run([*words, "-q", "--report", str(report)], capture_output=True, text=True)
    if not report.exists():
        sys.exit(f"{' '.join(words)} failed: {done.stderr.strip()}")
    told = json.loads(report.read_text())
    return {**stages(told), "all": told["seconds"], "peak, MB": told["peak_memory_bytes"] / 1e6}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("mesh")
    parser.add_argument("--resolutions", default="256,512,1024")
    parser.add_argument("--verb", default="repair --method voxel")
    parser.add_argument("--runs", type=int, default=3)
    args = parser.parse_args()
    sizes = [int(size) for size in args.resolutions.split(",")]
    table = {}
    with tempfile.TemporaryDirectory() as folder:
        for size in sizes:
            for _ in range(args.runs):
                for row, value in run(args.program, args.verb, args.mesh, size, Path(folder)).items():
                    known = table.setdefault(row, {})
                    known[size] = min(known.get(size, math.inf), value)
    print("| stage | " + " | ".join(map(str, sizes)) + " | exponent |")
    print("|---|" + "---|" * (len(sizes) + 1))
    for row, values in table.items():
        first, last = values.get(sizes[0]), values.get(sizes[-1])
        tells = first and last and (last >= LEAST)
        exponent = f"{math.log(last / first) / math.log(sizes[-1] / sizes[0]):.2f}" if tells else ""
        cells = [f"{values[size]:.2f}" if size in values else "" for size in sizes]
        print(f"| {row} | " + " | ".join(cells) + f" | {exponent} |")


if __name__ == "__main__":
    main()
