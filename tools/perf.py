#!/usr/bin/env python3
"""Two builds of the program on the same jobs in one run: how much faster or slower the second one is.

    tools/perf.py BASE NEW [--runs 5] [--quick] [--only WORD] [--limit 1.5] [--json FILE]

Machines are shared and noisy, so that seconds of two days say little. Here both programs take turns at every job, each time the other one first; what is compared is processor time (user and system),
least of the runs, beside wall time and peak memory. "spread" is the range of the ratios of the single rounds. Exit status 1 where a ratio of processor times is over the limit, or where a program fails.

Inputs are made here, or lie in testdata; real meshes are used where ../shared/data is. --quick: four short jobs, three rounds. Needs nothing beside Python.
"""
from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT.parent / "shared" / "data"


def ball(path, rows, centre=(0.0, 0.0, 0.0), hole=0):
    """A ball of about 4 rows² triangles as OBJ; without the triangles of the first `hole` rings."""
    columns = 2 * rows
    with open(path, "w", encoding="ascii") as out:
        for row in range(1, rows):
            polar = math.pi * row / rows
            for column in range(columns):
                turn = 2 * math.pi * column / columns
                x, y, z = math.sin(polar) * math.cos(turn), math.sin(polar) * math.sin(turn), math.cos(polar)
                out.write(f"v {x + centre[0]!r} {y + centre[1]!r} {z + centre[2]!r}\n")
        out.write(f"v {centre[0]!r} {centre[1]!r} {1 + centre[2]!r}\n")
        out.write(f"v {centre[0]!r} {centre[1]!r} {centre[2] - 1!r}\n")
        at = lambda row, column: (row - 1) * columns + column % columns + 1
        top, low = (rows - 1) * columns + 1, (rows - 1) * columns + 2
        for column in range(columns):
            if hole == 0:
                out.write(f"f {top} {at(1, column)} {at(1, column + 1)}\n")
            for row in range(max(1, hole), rows - 1):
                a, b, c, d = at(row, column), at(row, column + 1), at(row + 1, column), at(row + 1, column + 1)
                out.write(f"f {a} {c} {d}\nf {a} {d} {b}\n")
            out.write(f"f {low} {at(rows - 1, column + 1)} {at(rows - 1, column)}\n")


def jobs(folder):
    """(name, whether it is short, arguments without the output)."""
    whole, other, open_ball, small = (folder / f"{name}.obj" for name in ("whole", "other", "open", "small"))
    ball(whole, 200)
    ball(other, 200, (0.5, 0.3, 0.2))
    ball(open_ball, 150, hole=20)
    ball(small, 40)
    mug = ROOT / "testdata" / "broken_mug.obj"
    real = lambda name, made: DATA / name if (DATA / name).exists() else made
    return [
        ("repair, nothing to do", True, ["repair", whole]),
        ("repair, a hole", True, ["repair", real("broken/stanford-bunny.obj", open_ball)]),
        ("repair, crossings", False, ["repair", real("broken/cycloidal.ply", mug)]),
        ("repair, voxels", False, ["repair", real("broken/stanford-bunny.obj", open_ball), "--method", "voxel", "--resolution", "256"]),
        ("repair --rebuild", True, ["repair", mug, "--rebuild", "--resolution", "128"]),
        ("union", True, ["union", whole, other]),
        ("difference", False, ["difference", real("clean/fandisk.off", whole), other]),
        ("close", False, ["close", small, "--radius", "0.1", "--resolution", "96"]),
        ("sdf", False, ["sdf", whole, "--resolution", "192"]),
        ("field, offset", False, ["field", "offset(a, 4%)", f"a={small}", "--resolution", "96"]),
    ]


def run(program, words, out):
    """(processor seconds, wall seconds, peak memory in MB) of one run."""
    start = time.perf_counter()
    child = subprocess.Popen([program, *map(str, words), "-o", out, "--force", "-q"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    error = child.stderr.read()
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode not in (0, 3):
        sys.exit(f"{program} {' '.join(map(str, words))}: {child.returncode}: {error.decode(errors='replace').strip()[-300:]}")
    return usage.ru_utime + usage.ru_stime, time.perf_counter() - start, usage.ru_maxrss / 1024


def compared(programs, words, out, rounds):
    """The figures of both programs, each a list over the rounds."""
    found = ([], [])
    for program in programs:
        run(program, words, out)  # Files and caches are warm for both.
    for number in range(rounds):
        for which in ((0, 1), (1, 0))[number % 2]:
            found[which].append(run(programs[which], words, out))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("base")
    parser.add_argument("new")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--limit", type=float, default=1.5)
    parser.add_argument("--json")
    arguments = parser.parse_args()
    programs = [str(Path(path).resolve()) for path in (arguments.base, arguments.new)]
    rounds = 3 if arguments.quick else arguments.runs
    rows = []
    print("| job | base, processor s | new | ratio | spread | wall | memory, MB | ratio |\n|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for name, short, words in jobs(folder):
            if (arguments.quick and not short) or arguments.only not in name:
                continue
            out = folder / ("out.npy" if words[0] in ("sdf", "field") else "out.stl")
            base, new = compared(programs, words, out, rounds)
            least = [[min(one[k] for one in runs) for k in range(3)] for runs in (base, new)]
            ratios = [b[0] / max(a[0], 1e-3) for a, b in zip(base, new)]
            ratio, wall, memory = (least[1][k] / max(least[0][k], 1e-3) for k in range(3))
            rows.append({"job": name, "base": least[0], "new": least[1], "ratio": ratio, "spread": [min(ratios), max(ratios)]})
            print(f"| {name} | {least[0][0]:.3g} | {least[1][0]:.3g} | {ratio:.2f} | {min(ratios):.2f} to {max(ratios):.2f} | {wall:.2f} "
                  f"| {least[0][2]:.0f} | {memory:.2f} |", flush=True)
    if arguments.json:
        Path(arguments.json).write_text(json.dumps(rows, indent=1))
    slower = [row["job"] for row in rows if row["ratio"] > arguments.limit]
    if slower or not rows:
        sys.exit(f"more than {arguments.limit} times as long: {', '.join(slower)}" if slower else "no such job")


if __name__ == "__main__":
    main()
