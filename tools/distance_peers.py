#!/usr/bin/env python3
"""The exact distance field against OpenVDB's meshToVolume (time, values) and libigl's pseudonormal distance (values).

    tools/distance_peers.py PROGRAM [--runs 3] [--only WORD] [--no-values] [--no-openvdb]
                            [--methods characteristics,prism,exact@gpu]

Needs numpy, libigl and, for OpenVDB, g++ with libopenvdb-dev and libboost-dev; without these its columns are left out.
Rows are those of Sigg et al. 2003, Tables 1 to 4. Both programs run on all cores, one after the other, and the
seconds are those of the field alone: without reading, writing, and what both need once for a process. Each of
`--methods` (comma-separated, may be empty; METHOD@BACKEND) adds a column with the seconds of that --method of ours. These take closed meshes only: they get what
`repair --resolution 256` makes of the bunny.
"""
import argparse
import json
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
BUNNY = ROOT.parent / "shared" / "data" / "broken" / "stanford-bunny.obj"
KNOT = ROOT.parent / "shared" / "data" / "clean" / "quadknot.obj"
SPHERES = {2048: 4, 8192: 5, 32768: 6, 131072: 7}


def sphere(times):
    """An octahedron whose sides are cut in four `times` times, on the unit sphere."""
    triangles = []
    for n in range(8):
        corners = [np.eye(3)[k] * (1 if n >> k & 1 == 0 else -1) for k in range(3)]
        triangles.append(corners if bin(n).count("1") % 2 == 0 else corners[::-1])
    triangles = np.array(triangles)
    for _ in range(times):
        a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
        d, e, f = ((p + q) / np.linalg.norm(p + q, axis=1, keepdims=True) for p, q in ((a, b), (b, c), (c, a)))
        triangles = np.concatenate([np.stack(t, 1) for t in ((a, d, f), (d, b, e), (f, e, c), (d, e, f))])
    points, index = np.unique(triangles.reshape(-1, 3).round(12), axis=0, return_inverse=True)
    return points, index.reshape(-1, 3)


def read_obj(path):
    lines = [line.split() for line in open(path, encoding="utf-8", errors="replace")]
    points = np.array([line[1:4] for line in lines if line and line[0] == "v"], float)
    polygons = [[int(word.split("/")[0]) - 1 for word in line[1:]] for line in lines if line and line[0] == "f"]
    faces = [[p[0], p[k], p[k + 1]] for p in polygons for k in range(1, len(p) - 1)]
    return points, np.array(faces)


def write_obj(path, points, faces):
    with open(path, "w", encoding="ascii") as out:
        out.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
        out.writelines(f"f {a} {b} {c}\n" for a, b, c in (faces + 1).tolist())


def build_openvdb(folder):
    compiler, program = shutil.which("g++"), folder / "distance_openvdb"
    if compiler is None:
        return None
    source = ROOT / "tools" / "distance_openvdb.cpp"
    command = [compiler, "-O2", "-std=c++17", source, "-o", program, "-lopenvdb", "-ltbb"]
    # Where the half floats of OpenVDB live depends on its version.
    built = any(subprocess.run(command + more, capture_output=True).returncode == 0 for more in (["-lImath"], ["-lHalf"], []))
    return program if built else None


def read_nrrd(path):
    data = path.read_bytes()
    end = data.index(b"\n\n")
    header = data[:end].decode()
    field = lambda key: [float(x) for x in re.findall(r"[-+.\de]+", re.search(rf"^{key}:(.*)$", header, re.M)[1])]
    size = [int(x) for x in field("sizes")]
    values = np.frombuffer(data, "<f4", offset=end + 2).reshape(size, order="F")
    return values, np.array(field("space origin")), field("space directions")[0]


def values_of_igl(points, faces, places):
    import igl
    result = igl.signed_distance(places, points, faces.astype(np.int64), sign_type=igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL)
    return result[0]


def differences(values, truth, h):
    off = np.abs(np.abs(values) - np.abs(truth)).max() / h
    wrong = int(((values < 0) != (truth < 0))[np.abs(truth) > 1e-6 * h].sum())
    return f"{off:.1e}", str(wrong)


def seconds_of(method, source, out, resolution, band, args):
    """Seconds of the field alone, the least of all runs."""
    report, seconds = out.with_suffix(".json"), []
    method, _, backend = method.partition("@")
    for _ in range(args.runs):
        command = [args.program, "sdf", source, "-o", out, "--force", "--resolution", str(resolution), "--band", repr(band),
                   "--method", method, "--sign", "pseudonormal", "--report", report, "-q"]
        command += ["--backend", backend] if backend else []
        subprocess.run(command, check=True)
        found = json.loads(report.read_text())
        seconds += [stage["seconds"] for stage in found["stages"] if stage["stage"] == "distance"]
    return min(seconds)


def closed(source, folder, args):
    """The mesh itself if it is a valid solid, else its repair."""
    out = folder / "closed.obj"
    subprocess.run([args.program, "repair", source, "-o", out, "--force", "--resolution", "256", "-q"], check=True)
    return out


def row(name, mesh, resolution, share, args, openvdb, folder):
    points, faces = mesh
    source, out = folder / "mesh.obj", folder / "field.nrrd"
    write_obj(source, points, faces)
    longest = float((points.max(0) - points.min(0)).max())
    h = longest / resolution
    band = share * longest
    best = seconds_of("exact", source, out, resolution, band, args)
    values, origin, _ = read_nrrd(out)
    inside = np.abs(values) < np.float32(band)
    voxels = int(inside.sum())
    cells = [name, f"{resolution}³", f"{share}", f"{voxels / 1e6:.2f}", f"{best:.3f}", f"{best / voxels * 1e9:.0f}"]
    other = folder / "other.nrrd"
    solid = closed(source, folder, args) if name == "bunny" and args.methods else source
    cells += [f"{seconds_of(method, solid, other, resolution, band, args):.3f}" for method in args.methods]
    spread = np.random.default_rng(1).choice(np.flatnonzero(inside.reshape(-1, order="F")), 20_000)
    at = np.stack(np.unravel_index(spread, values.shape, order="F"), 1)
    ours = values[tuple(at.T)].astype(float)
    truth = None
    if args.values:
        truth = values_of_igl(points, faces, origin + h * at)
        cells += differences(ours, truth, h)
    else:
        cells += ["", ""]
    if openvdb is None:
        return cells
    peers, asked = [], "\n".join(" ".join(map(str, voxel)) for voxel in at.tolist())
    for n in range(args.runs):
        command = [openvdb, source, repr(h), repr(band / h), *map(repr, origin.tolist())]
        last = n + 1 == args.runs and args.values
        text = subprocess.run(command + ["values"] * last, input=asked, capture_output=True, text=True, check=True).stdout
        lines = text.split("\n", 1)
        peers.append(lines[0].split())
    best_peer = min(float(seconds) for seconds, _ in peers)
    cells += [f"{int(peers[0][1]) / 1e6:.2f}", f"{best_peer:.3f}", f"{best_peer / best:.1f}"]
    if truth is not None:
        cells += differences(np.array(lines[1].split(), float) * h, truth, h)
    return cells


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--only", default="")
    parser.add_argument("--no-values", dest="values", action="store_false")
    parser.add_argument("--no-openvdb", dest="openvdb", action="store_false")
    parser.add_argument("--methods", type=lambda text: text.split(",") if text else [], default="characteristics")
    args = parser.parse_args()
    args.program = args.program.resolve()
    rows = [("bunny", read_obj(BUNNY), resolution, 0.1) for resolution in (256, 64, 128)]
    rows += [("knot", read_obj(KNOT), 256, 0.1)]
    rows += [(f"sphere {count}", sphere(times), 256, 0.1) for count, times in SPHERES.items()]
    rows += [("sphere 32768", sphere(6), 256, share) for share in (0.2, 0.4, 0.8)]
    rows += [("sphere 32768", sphere(6), resolution, 0.1) for resolution in (64, 128, 512)]
    methods = "".join(f"{method}, s | " for method in args.methods)
    print(f"| mesh | grid | band | voxels, M | s | ns a voxel | {methods}max error h | wrong signs | OpenVDB: voxels, M | s "
          "| times ours | max error h | wrong signs |")
    print("|---" * (13 + len(args.methods)) + "|")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        openvdb = build_openvdb(folder) if args.openvdb else None
        for name, mesh, resolution, share in rows:
            if args.only in f"{name} {resolution} {share}":
                cells = row(name, mesh, resolution, share, args, openvdb, folder)
                print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
