#!/usr/bin/env python3
"""Peak memory over planned memory, for every verb that plans: the table of docs/benchmarks.md.

tools/plan.py PROGRAM [--quick] [--resolution 128,256,512] [--data FOLDER] [--only WORD] [--verbs repair,union] [--rows FILE.json]

Each run is planned with --plan and then made; the peak is that of the report. --quick: made shapes at 64 alone, and an error
when a plan is not between half the peak and 2.5 times the peak (small runs are mostly the program itself, and of a ball all
triangles are as far from its middle). --rows: everything that
was measured, for fitting the constants of src/pipeline/plan.rs again.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT.parent / "shared" / "data"

# What is planned: the name in the table, the verb, and its flags.
WAYS = [
    ("repair", ["repair"], 1),
    ("repair --rebuild", ["repair", "--rebuild"], 1),
    ("repair --no-fit", ["repair", "--no-fit"], 1),
    ("union", ["union"], 2),
    ("dilate 2h", ["dilate", "--radius", "2h"], 1),
    ("close 4h", ["close", "--radius", "4h"], 1),
    ("canals 8h", ["canals", "--max-diameter", "8h"], 1),
    ("thicken 4h", ["thicken", "--min", "4h"], 1),
    ("sdf", ["sdf"], 1),
    ("sdf --sign winding", ["sdf", "--sign", "winding"], 1),
    ("sdf --sign levels", ["sdf", "--sign", "levels"], 1),
    ("sdf --sign votes", ["sdf", "--sign", "votes"], 1),
    ("sdf --method robust", ["sdf", "--method", "robust"], 1),
    ("sdf --band full", ["sdf", "--band", "full"], 1),
]


def tetrahedron(path):
    path.write_text("OFF\n4 4 0\n0 0 0\n40 0 0\n0 40 0\n0 0 40\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")


def ball(path, n=120, hole=False):
    """A ball of about 2 n² triangles, perhaps with its cap missing."""
    points, faces = [], []
    for i in range(n + 1):
        for k in range(n):
            a, b = math.pi * i / n, 2 * math.pi * k / n
            points.append((math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a)))
    for i in range(n // 12 if hole else 0, n):
        for k in range(n):
            a, b, c, d = i * n + k, i * n + (k + 1) % n, (i + 1) * n + (k + 1) % n, (i + 1) * n + k
            faces += [(a, d, c)] if i == 0 else [(a, c, b)] if i == n - 1 else [(a, d, c), (a, c, b)]
    if not hole:
        # The rows at the poles are one point each.
        faces = [tuple(0 if v < n else n * n if v >= n * n else v for v in face) for face in faces]
    lines = [f"OFF\n{len(points)} {len(faces)} 0"]
    lines += ["%.9g %.9g %.9g" % point for point in points]
    lines += ["3 %d %d %d" % face for face in faces]
    path.write_text("\n".join(lines) + "\n")


def made(folder):
    tetrahedron(folder / "tetrahedron.off")
    ball(folder / "ball.off")
    ball(folder / "open_ball.off", hole=True)
    return sorted(folder.glob("*.off"))


def moved(program, mesh, folder):
    """The same mesh a third of its size away, so that a union of both has something to cut."""
    path = folder / "moved.off"
    subprocess.run([program, "convert", mesh, "-o", path, "-q"], capture_output=True)
    lines = path.read_text().splitlines()
    count = int(lines[1].split()[0])
    points = [[float(word) for word in line.split()[:3]] for line in lines[2 : 2 + count]]
    by = [0.31 * (max(p[k] for p in points) - min(p[k] for p in points)) for k in range(3)]
    lines[2 : 2 + count] = [" ".join(repr(p[k] + by[k]) for k in range(3)) for p in points]
    path.write_text("\n".join(lines) + "\n")
    return path


def run(program, words, limit):
    try:
        done = subprocess.run([program, *map(str, words), "--json", "-q"], capture_output=True, text=True, timeout=limit)
        return json.loads(done.stdout)
    except (subprocess.TimeoutExpired, ValueError):
        return None


def measure(program, way, words, count, mesh, resolution, folder, limit):
    inputs = [mesh] if count == 1 else [mesh, moved(program, mesh, folder)]
    out = folder / ("out.nrrd" if words[0] == "sdf" else "out.stl")
    output = {"canals": [], "sdf": ["-o", out]}.get(words[0], ["-o", out, "--keep-partial"])
    command = [words[0], *inputs, *words[1:], "--resolution", str(resolution)]
    planned = run(program, [*command, "--plan"], limit)
    done = run(program, [*command, *output], limit)
    if not planned or not done or not planned.get("result") or done["exit"] not in (0, 3) or "error" in done:
        return None
    row = {"way": way, "file": mesh.name, "resolution": resolution}
    row |= {"plan": planned["result"]["plan"]["memory"], "peak": done["peak_memory_bytes"], "report": done}
    row["over"] = row["plan"] / row["peak"]
    return row


def table(rows):
    """For each way and resolution the spread of plan over peak."""
    print("| verb | at | runs | plan over peak: least | median | most | peak MB, largest | outside 1 to 1.3, over 100 MB |")
    print("|---|---|---|---|---|---|---|---|")
    for way in dict.fromkeys(row["way"] for row in rows):
        for at in sorted({row["resolution"] for row in rows}):
            some = sorted((row for row in rows if (row["way"], row["resolution"]) == (way, at)), key=lambda row: row["over"])
            if not some:
                continue
            large = [row for row in some if row["peak"] > 100e6]
            off = [f"{row['file']} {row['over']:.2f}" for row in large if not 1 <= row["over"] <= 1.3]
            spread = [some[0]["over"], some[len(some) // 2]["over"], some[-1]["over"]]
            least, median, most = ("%.2f" % value for value in spread)
            peak = max(row["peak"] for row in some) / 1e6
            print(f"| {way} | {at} | {len(some)} | {least} | {median} | {most} | {peak:.0f} | {', '.join(off)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda path: str(Path(path).resolve()))
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--resolution", default="128,256,512")
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--only", default="")
    parser.add_argument("--verbs", default="")
    parser.add_argument("--rows", type=Path)
    parser.add_argument("--limit", type=float, default=120, help="seconds a run may take; longer ones are left out")
    args = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if args.quick:
            meshes, resolutions = made(folder), [64]
        else:
            kinds = ("clean", "broken", "odd")
            meshes = sorted(path for kind in kinds for path in (args.data / kind).iterdir())
            resolutions = [int(word) for word in args.resolution.split(",")]
        meshes = [mesh for mesh in meshes if args.only in mesh.name]
        ways = [way for way in WAYS if not args.verbs or way[0] in args.verbs.split(",")]
        for resolution in resolutions:
            for way, words, count in ways:
                for mesh in meshes:
                    row = measure(args.program, way, words, count, mesh, resolution, folder, args.limit)
                    if row:
                        rows.append(row)
                        if args.rows:
                            args.rows.write_text(json.dumps(rows))
    table(rows)
    if args.quick:
        bad = [row for row in rows if not 0.5 <= row["over"] <= 2.5]
        for row in bad:
            print(f"{row['way']} {row['file']}: {row['plan'] / 1e6:.0f} MB planned, {row['peak'] / 1e6:.0f} MB used", file=sys.stderr)
        sys.exit(bool(bad) or not rows)


if __name__ == "__main__":
    main()
