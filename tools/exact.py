#!/usr/bin/env python3
"""The exact way against manifold3d, and trueform where it is installed, file to file and by itself: the tables of docs/benchmarks.md and docs/accuracy.md.

    tools/exact.py PROGRAM [--runs 3] [--quick] [--install]

Needs numpy and manifold3d; --install fetches them, and trueform. Every input is made here. For each pair: seconds of the whole program, file to
file with verification (least of the runs); seconds of its arrangement alone (stages `shells` and `arrange` of the report); seconds of manifold3d alone, from arrays to volume, and of trueform, from arrays to arrays; peak memory
of the program; and the volume against that of manifold3d. Exit status 1 if a volume is off by more than a millionth.
"""
import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path


def sphere(n, turn=0.0, by=(0, 0, 0)):
    """A ball of about 2 n² triangles."""
    import numpy as np

    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(1, n) * np.pi / n)
    ring = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], -1).reshape(-1, 3)
    points = np.concatenate([ring, [[0, 0, 1], [0, 0, -1]]])
    at = lambda row, column: (row * n + column % n)
    faces = []
    columns = np.arange(n)
    for row in range(n - 2):
        a, b, c, d = at(row, columns), at(row, columns + 1), at(row + 1, columns), at(row + 1, columns + 1)
        faces += [np.stack([a, c, b], -1), np.stack([b, c, d], -1)]
    top, bottom = len(points) - 2, len(points) - 1
    faces += [np.stack([np.full(n, top), at(0, columns), at(0, columns + 1)], -1),
              np.stack([np.full(n, bottom), at(n - 2, columns + 1), at(n - 2, columns)], -1)]
    c, s = np.cos(turn), np.sin(turn)
    matrix = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    return single(points @ matrix.T + np.array(by)), np.concatenate(faces)


def single(points):
    import numpy as np

    return points.astype(np.float32).astype(np.float64)


def box(low, high):
    import numpy as np

    corners = np.array([[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)], float)
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return corners, np.array([t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])])


def drill(x, y, radius, sides=16):
    import numpy as np

    angle = np.arange(sides) * 2 * np.pi / sides
    ring = np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], -1)
    points = np.concatenate([np.column_stack([ring, np.full(sides, z)]) for z in (-1.0, 2.0)])
    k = np.arange(sides)
    next_k = (k + 1) % sides
    walls = np.concatenate([np.stack([k, next_k, next_k + sides], -1), np.stack([k, next_k + sides, k + sides], -1)])
    caps = [[0, j + 1, j] for j in range(1, sides - 1)] + [[sides, sides + j, sides + j + 1] for j in range(1, sides - 1)]
    return single(points), np.concatenate([walls, np.array(caps)])


def write(path, mesh):
    points, faces = mesh
    lines = ["v %r %r %r" % tuple(map(float, p)) for p in points] + ["f %d %d %d" % tuple(t + 1) for t in faces]
    path.write_text("\n".join(lines) + "\n")


def read(path):
    import numpy as np

    points, faces = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(x) for x in words[1:4]])
        elif words[:1] == ["f"]:
            faces.append([int(x.split("/")[0]) - 1 for x in words[1:4]])
    return np.array(points), np.array(faces)


def volume(mesh):
    points, faces = mesh
    import numpy as np

    a, b, c = (points[faces[:, k]] - points[0] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def ours(program, arguments, out, runs):
    """Of the quickest run its seconds, those of its arrangement, and megabytes."""
    best = None
    for _ in range(runs):
        report = out.with_suffix(".json")
        start = time.perf_counter()
        done = subprocess.run([program, *arguments, "-o", out, "--report", report, "-q"], capture_output=True, text=True)
        seconds = time.perf_counter() - start
        if done.returncode:
            sys.exit(f"{arguments}: {done.stderr}")
        told = json.loads(report.read_text())
        stages = {stage["stage"]: stage["seconds"] for stage in told["stages"]}
        inner = stages.get("shells", 0) + stages.get("arrange", 0)
        row = (seconds, inner, told["peak_memory_bytes"] / 1e6)
        best = min(best, row, key=lambda r: r[0]) if best else row
    return best


def theirs(a, b, operation, runs):
    import manifold3d
    import numpy as np

    best = None
    for _ in range(runs):
        start = time.perf_counter()
        m, n = (manifold3d.Manifold(manifold3d.Mesh64(p.astype(np.float64), f.astype(np.uint64))) for p, f in (a, b))
        result = {"union": m + n, "intersection": m ^ n, "difference": m - n}[operation]
        found = result.volume()
        best = min(best, (time.perf_counter() - start, found)) if best else (time.perf_counter() - start, found)
    return best


def trueform(a, b, operation, runs):
    """Its seconds, in words; nothing where it is not there."""
    import numpy as np

    try:
        import trueform as tf
    except ImportError:
        return ""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        m, n = (tf.Mesh(f.astype(np.int32), p.astype(np.float64)) for p, f in (a, b))
        getattr(tf, f"boolean_{operation}")(m, n)
        times.append(time.perf_counter() - start)
    return f"{min(times):.3f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--quick", action="store_true", help="small inputs only")
    parser.add_argument("--install", action="store_true", help="fetch numpy and manifold3d first")
    args = parser.parse_args()
    if args.install:
        subprocess.run([sys.executable, "-m", "pip", "install", "-q", "numpy", "manifold3d", "trueform"], check=True)
    program, wrong = args.program.resolve(), 0
    sizes = [16, 32, 64] if args.quick else [16, 64, 128, 256, 500]
    print("| input | triangles | operation | program s | arrangement s | MB | manifold3d s | trueform s | volume off by |\n|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for n in sizes:
            a, b = sphere(n), sphere(n, 0.7, (0.5, 0.3, 0.2))
            write(folder / "a.obj", a)
            write(folder / "b.obj", b)
            for operation in ("union", "difference") if n < 500 else ("union",):
                out = folder / "out.obj"
                seconds, inner, memory = ours(program, [operation, folder / "a.obj", folder / "b.obj"], out, args.runs)
                peer, wanted = theirs(a, b, operation, args.runs)
                off = abs(volume(read(out)) / wanted - 1)
                wrong += off > 1e-6
                print(f"| two balls | {2 * len(a[1]):,} | {operation} | {seconds:.3f} | {inner:.3f} | {memory:.0f} | {peer:.3f} | {trueform(a, b, operation, args.runs)} | {off:.1e} |", flush=True)
        wrong += chain(program, folder, 10 if args.quick else 100)
    sys.exit(1 if wrong else 0)


def chain(program, folder, count):
    """A plate drilled one file after another, and at once."""
    import numpy as np

    wrong = 0
    side = int(np.ceil(np.sqrt(count)))
    plate = box((0, 0, 0), (side, side, 1))
    drills = [drill(n % side + 0.5, n // side + 0.5, 0.3) for n in range(count)]
    area = lambda d: volume(d) / 3
    wanted = volume(plate) - sum(map(area, drills))
    for n, tool in enumerate(drills):
        write(folder / f"drill{n}.obj", tool)
    write(folder / "plate.obj", plate)
    now, start = folder / "plate.obj", time.perf_counter()
    for n in range(count):
        out = folder / f"plate{n % 2}.obj"
        subprocess.run([program, "difference", now, folder / f"drill{n}.obj", "-o", out, "-q"], check=True)
        now = out
    seconds = time.perf_counter() - start
    off = abs(volume(read(now)) / wanted - 1)
    print(f"| a plate drilled {count} times, one file after another | {len(read(now)[1]):,} | difference | {seconds:.2f} | | | | | {off:.1e} |")
    wrong += off > 1e-6
    expression = f"p - ({' | '.join(f'd{n}' for n in range(count))})"
    inputs = [f"p={folder / 'plate.obj'}"] + [f"d{n}={folder / f'drill{n}.obj'}" for n in range(count)]
    out = folder / "csg.obj"
    start = time.perf_counter()
    subprocess.run([program, "csg", expression, *inputs, "-o", out, "-q"], check=True)
    seconds = time.perf_counter() - start
    off = abs(volume(read(out)) / wanted - 1)
    print(f"| the same as one csg | {len(read(out)[1]):,} | csg | {seconds:.2f} | | | | | {off:.1e} |")
    return wrong + (off > 1e-6)


if __name__ == "__main__":
    main()
