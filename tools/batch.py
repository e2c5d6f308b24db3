#!/usr/bin/env python3
"""How much a batch of many small files takes beyond the files themselves.

    python3 tools/batch.py                      1,000 small meshes, repaired by target/release/meshwright
    python3 tools/batch.py --program PATH --files 200 --rounds 2

Makes the meshes (balls, some with a hole, some with turned triangles, of 128 to 2,048 triangles), runs each alone with one thread, one after
the other, and all of them as a batch; does so in rounds, so that what else the machine does falls on both. Prints the sum of their own times over
the cores, the time of the batch, and the ratio; exit status 1 when that is more than 1.15, or when a job is not done.
"""

import argparse
import json
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MOST = 1.15


def ball(times):
    """The triangles of an octahedron, each cut into four so many times, on a ball."""
    x, y, z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    minus = lambda p: tuple(-c for c in p)
    made = [(a, b, c) for a in (x, minus(x)) for b in (y, minus(y)) for c in (z, minus(z))]
    turned = lambda t: sum(t[0]) * sum(t[1]) * sum(t[2]) < 0
    made = [(t[0], t[2], t[1]) if turned(t) else t for t in made]
    def middle(p, q):
        sums = [a + b for a, b in zip(p, q)]
        length = math.sqrt(sum(c * c for c in sums))
        return tuple(c / length for c in sums)
    for _ in range(times):
        cut = []
        for a, b, c in made:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            cut += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        made = cut
    return made


def write(path, number):
    """The mesh of this number, as binary STL."""
    triangles = ball(2 + number % 3)
    if number % 4 == 1:
        triangles = triangles[:-3]
    if number % 4 == 2:
        triangles = [(a, c, b) if n % 7 == 0 else (a, b, c) for n, (a, b, c) in enumerate(triangles)]
    scale = 1 + number / 100
    with open(path, "wb") as file:
        file.write(bytes(80) + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<12fH", 0, 0, 0, *(scale * c for corner in triangle for c in corner), 0))


def cpu():
    """Processor seconds of all processes that have been waited for."""
    times = os.times()
    return times.children_user + times.children_system


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=ROOT / "target/release/meshwright", type=Path)
    parser.add_argument("--files", default=1000, type=int)
    parser.add_argument("--rounds", default=5, type=int)
    parser.add_argument("--cores", default=os.cpu_count(), type=int)
    args = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="batch-"))
    alone = batch = alone_cpu = batch_cpu = 0.0
    done = 0
    try:
        for turn in range(args.rounds):
            inputs = folder / f"in{turn}"
            inputs.mkdir()
            names = [f"{n:04}.stl" for n in range(turn, args.files, args.rounds)]
            for name in names:
                write(inputs / name, int(name[:4]))
            (folder / "alone").mkdir(exist_ok=True)
            begin, spent = time.monotonic(), cpu()
            for name in names:
                command = [args.program, "repair", inputs / name, "-o", folder / "alone" / name, "--threads", "1", "-q"]
                subprocess.run(command, check=True)
            alone, alone_cpu = alone + time.monotonic() - begin, alone_cpu + cpu() - spent
            out = folder / f"out{turn}"
            begin, spent = time.monotonic(), cpu()
            command = [args.program, "batch", "repair", inputs, "--out", out, "--threads", str(args.cores), "-q"]
            subprocess.run(command, check=True)
            batch, batch_cpu = batch + time.monotonic() - begin, batch_cpu + cpu() - spent
            entries = [json.loads(line) for line in (out / "batch.jsonl").read_text().splitlines()]
            done += sum(entry["class"] == "done" for entry in entries)
            for name in names:
                if (out / name).read_bytes() != (folder / "alone" / name).read_bytes():
                    sys.exit(f"{name} is another file in the batch than alone")
    finally:
        shutil.rmtree(folder)
    own = alone / args.cores
    print(f"files {args.files}, done {done}, cores {args.cores}")
    print(f"alone {alone:.1f} s, over the cores {own:.1f} s, of the processor {alone_cpu:.1f} s")
    print(f"batch {batch:.1f} s, of the processor {batch_cpu:.1f} s")
    print(f"ratio {batch / own:.3f}, of processor times {batch_cpu / alone_cpu:.3f}")
    sys.exit(done != args.files or batch / own > MOST)


if __name__ == "__main__":
    main()
