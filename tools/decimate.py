#!/usr/bin/env python3
"""Decimation to a half and a tenth against pymeshlab's quadric edge collapse and fast-simplification.

    tools/decimate.py PROGRAM [FILE...] [--runs N] [--samples N]

Needs pymeshlab, fast-simplification, libigl, numpy and the checks of ../shared/eval. Without files, three of
../shared/data/clean. Prints a table in Markdown. Errors are the means of the distances of area-uniform samples, from the
file to the result and back, in millionths of the diagonal; "worst" is the largest of these and of the vertices'. Seconds: `s` is
the decimation alone (for ours with the check that the input is a valid solid and the result is one), the best of the
runs; `file to file` are processor seconds with reading and writing, and for ours with verifying the written file and measuring how far
the surface has moved; imports of Python are not counted.
"""
from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "../shared/eval"))

import fast_simplification  # noqa: E402
import igl  # noqa: E402
import numpy as np  # noqa: E402
import pymeshlab  # noqa: E402
import score  # noqa: E402
import trimesh  # noqa: E402

FILES = ["fandisk.off", "rocker-arm.obj", "520644.stl"]
SHARES = [0.5, 0.1]


def samples(v: np.ndarray, f: np.ndarray, count: int, seed: int) -> np.ndarray:
    random = np.random.default_rng(seed)
    area = np.linalg.norm(np.cross(v[f[:, 1]] - v[f[:, 0]], v[f[:, 2]] - v[f[:, 0]]), axis=1)
    face = random.choice(len(f), count, p=area / area.sum())
    r = random.random((count, 2))
    s = np.sqrt(r[:, :1])
    return v[f[face, 0]] * (1 - s) + v[f[face, 1]] * s * (1 - r[:, 1:]) + v[f[face, 2]] * s * r[:, 1:]


def distances(a: tuple, b: tuple, count: int, seed: int) -> tuple[float, float]:
    """Mean over samples of a, and the largest over these and a's vertices, to b."""
    to = lambda p: np.sqrt(igl.point_mesh_squared_distance(p, b[0], b[1])[0])  # noqa: E731
    sampled = to(samples(a[0], a[1], count, seed))
    return float(sampled.mean()), float(max(sampled.max(), to(a[0][np.unique(a[1])]).max()))


def children() -> float:
    """Processor seconds of all processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def ours(program: str, path: Path, share: float, folder: Path) -> tuple[Path, float, float]:
    out = folder / "ours.ply"
    start = children()
    text = subprocess.run(
        [program, "decimate", path, "-o", out, "--ratio", str(share), "--json", "-q"],
        check=True,
        capture_output=True,
    ).stdout
    whole = children() - start
    stages = {stage["stage"]: stage["seconds"] for stage in json.loads(text)["stages"]}
    return out, stages["decimate"], whole


def quadric(path: Path, target: int, folder: Path) -> tuple[Path, float, float]:
    out = folder / "quadric.ply"
    start = time.process_time()
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(path))
    if path.suffix.lower() == ".stl":
        meshes.meshing_remove_duplicate_vertices()
    before = time.perf_counter()
    meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=target)
    alone = time.perf_counter() - before
    meshes.save_current_mesh(str(out), save_vertex_color=False)
    return out, alone, time.process_time() - start


def fast(path: Path, target: int, folder: Path) -> tuple[Path, float, float]:
    out = folder / "fast.ply"
    start = time.process_time()
    mesh = trimesh.load(path, process=path.suffix.lower() == ".stl", force="mesh")
    v, f = np.asarray(mesh.vertices, np.float32), np.asarray(mesh.faces, np.int32)
    before = time.perf_counter()
    v, f = fast_simplification.simplify(v, f, target_count=target)
    alone = time.perf_counter() - before
    trimesh.Trimesh(v, f, process=False).export(out)
    return out, alone, time.process_time() - start


def best(make, runs: int):
    made = [make() for _ in range(runs)]
    return made[0][0], min(m[1] for m in made), min(m[2] for m in made)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--samples", type=int, default=200_000)
    args = parser.parse_args()
    files = args.files or [ROOT / "../shared/data/clean" / name for name in FILES]
    print("| mesh | to | by | triangles | valid | mean error there, back | worst | s | file to file, processor s |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path in files:
            reference = score.load(path)
            diagonal = float(np.linalg.norm(reference[0].max(axis=0) - reference[0].min(axis=0)))
            for share in SHARES:
                target = round(len(reference[1]) * share)
                makers = {
                    "meshwright": lambda: ours(args.program, path, share, folder),
                    "pymeshlab quadric": lambda: quadric(path, target, folder),
                    "fast-simplification": lambda: fast(path, target, folder),
                }
                for by, make in makers.items():
                    out, alone, whole = best(make, args.runs)
                    v, f = score.load(out)
                    check = score.validity(v, f)
                    there, worst = distances(reference, (v, f), args.samples, 1)
                    back, worst_back = distances((v, f), reference, args.samples, 2)
                    millionths = lambda x: f"{1e6 * x / diagonal:.3g}"  # noqa: E731
                    print(
                        f"| {path.stem} | {share:g} | {by} | {len(f):,} | {'yes' if check['valid'] else 'no'} "
                        f"| {millionths(there)}, {millionths(back)} | {millionths(max(worst, worst_back))} "
                        f"| {alone:.3f} | {whole:.3f} |",
                        flush=True,
                    )


if __name__ == "__main__":
    main()
