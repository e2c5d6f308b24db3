#!/usr/bin/env python3
"""Holes whose truth is known, closed by the program and by others.

    tools/holes.py PROGRAM [--peers] [--seeds 5] [--sizes 2,5,10,20] [--styles auto,flat,smooth] [--only WORD] [--each]
    tools/holes.py PROGRAM --times       seconds over the number of holes in one mesh, from 1 to 1,000
    tools/holes.py PROGRAM --soups 2000  random soups with holes: each becomes a valid solid, or is refused with a reason

Needs numpy, scipy, libigl and the checks of ../shared/eval. Peers are pymeshfix (its filling of boundaries alone), MeshLib (fillHole with its
universal metric, and fillHoleNicely), both by pip, and CGAL's triangulate_refine_and_fair_hole (Debian's libcgal-dev and libeigen3-dev, g++); those that
are missing are named and left out.

Shapes are made here: a sphere, a torus, a cylinder and a box, turned anew for each seed; the real meshes are those of ../shared/data/clean. A hole is a round piece taken out of a
surface: the triangles whose middles are nearer to a random place than half of so many percent of the diagonal, as far as they hang together; a place around which that piece is no
disc is drawn again. At the box and the cylinder the place lies where the name says. All methods get the same file.

What is measured: distances from 10,000 samples of what was taken out to the whole result, and from 10,000 samples of the new triangles to the whole truth. "RMS" is the root of the mean of both
mean squares, "max" the largest of all with the vertices; both in percent of the hole's width. A result is valid when it is a closed, oriented manifold without
self-intersections, by an independent exact judge. Inputs and what peers make of them are kept in the temporary folder.
"""
from __future__ import annotations

import argparse
import hashlib
import importlib.metadata
import json
import shutil
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "../shared/eval"))

import igl  # noqa: E402
import numpy as np  # noqa: E402
import score  # noqa: E402
from scipy.sparse import coo_matrix  # noqa: E402
from scipy.sparse.csgraph import connected_components  # noqa: E402
from scipy.spatial import cKDTree  # noqa: E402

CLEAN = ROOT / "../shared/data/clean"
REAL = {"fandisk": "fandisk.off", "rocker-arm": "rocker-arm.obj", "screwdriver": "screwdriver.off"}
SAMPLES = 10_000


# ---------------------------------------------------------------- shapes


def write_obj(path, points, faces):
    # A run that is interrupted leaves no half of a file that the next one would take for the whole.
    part = Path(f"{path}.part")
    with open(part, "w", encoding="ascii") as out:
        out.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
        out.writelines(f"f {a} {b} {c}\n" for a, b, c in (faces + 1).tolist())
    part.rename(path)


def welded(points, faces):
    _, first, index = np.unique(points.round(9), axis=0, return_index=True, return_inverse=True)
    faces = index.ravel()[faces]
    whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return points[first], faces[whole]


def facing_out(mesh):
    points, faces = welded(*mesh)
    volume = np.einsum("ij,ij->i", points[faces[:, 0]], np.cross(points[faces[:, 1]], points[faces[:, 2]])).sum()
    return points, faces[:, ::-1] if volume < 0 else faces


def sheet(rows):
    """The triangles between points in rows, (n, m, 3)."""
    n, m = rows.shape[:2]
    a = (np.arange(n - 1)[:, None] * m + np.arange(m - 1)).ravel()
    b, c, d = a + 1, a + m + 1, a + m
    return rows.reshape(-1, 3), np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def joined(parts):
    points, faces, count = [], [], 0
    for p, f in parts:
        points.append(p)
        faces.append(f + count)
        count += len(p)
    return welded(np.concatenate(points), np.concatenate(faces))


def sphere(times=5):
    triangles = []
    for n in range(8):
        corners = [np.eye(3)[k] * (1 if n >> k & 1 == 0 else -1) for k in range(3)]
        triangles.append(corners if bin(n).count("1") % 2 == 0 else corners[::-1])
    triangles = np.array(triangles)
    for _ in range(times):
        a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
        d, e, f = ((p + q) / np.linalg.norm(p + q, axis=1, keepdims=True) for p, q in ((a, b), (b, c), (c, a)))
        triangles = np.concatenate([np.stack(t, 1) for t in ((a, d, f), (d, b, e), (f, e, c), (d, e, f))])
    return welded(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))


def angles(count):
    turn = np.linspace(0, 2 * np.pi, count + 1)
    turn[-1] = 0
    return turn


def torus(major=2.0, minor=0.8, columns=120, rows=48):
    u, v = np.meshgrid(angles(columns), angles(rows), indexing="ij")
    out = major + minor * np.cos(v)
    points, faces = sheet(np.stack([out * np.cos(u), out * np.sin(u), minor * np.sin(v)], 2))
    return facing_out((points, faces))


def cylinder(columns=96, rows=40, height=3.0):
    """Of radius 1, from z = 0, with flat ends of rings."""
    u = angles(columns)
    circle = np.stack([np.cos(u), np.sin(u), 0 * u], 1)
    up = np.array([0, 0, height])
    rings = np.linspace(0, 1, 13)
    side = np.stack([circle + up * t for t in np.linspace(0, 1, rows + 1)])
    side = side.transpose(1, 0, 2)
    top = np.stack([circle * r + up for r in rings[::-1]]).transpose(1, 0, 2)
    low = np.stack([circle * r for r in rings]).transpose(1, 0, 2)
    return facing_out(joined([sheet(part) for part in (low, side, top)]))


def box(size=(2.0, 1.5, 1.0), step=0.05):
    parts = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        nu, nv = (max(1, round(size[k] / step)) for k in (u, v))
        for side in (0, 1):
            rows = np.zeros((nu + 1, nv + 1, 3))
            rows[..., u] = np.linspace(0, size[u], nu + 1)[:, None]
            rows[..., v] = np.linspace(0, size[v], nv + 1)[None, :]
            rows[..., axis] = side * size[axis]
            p, f = sheet(rows)
            parts.append((p, f[:, ::-1] if side else f))
    return facing_out(joined(parts))


def on_edge_of_box(random):
    return np.array([random.uniform(0.6, 1.4), 1.5, 1.0])


CASES = {
    "sphere": (sphere, None),
    "torus": (torus, None),
    "cylinder, side": (cylinder, lambda r: np.array([np.cos(a := r.uniform(0, 7)), np.sin(a), r.uniform(1, 2)])),
    "cylinder, rim": (cylinder, lambda r: np.array([np.cos(a := r.uniform(0, 7)), np.sin(a), 3.0])),
    "cylinder, flat": (cylinder, lambda r: np.array([np.cos(a := r.uniform(0, 7)) * 0.5, np.sin(a) * 0.5, 3.0]) * [d := r.uniform(0, 1), d, 1]),
    "box, edge": (box, on_edge_of_box),
    "box, corner": (box, lambda r: np.array([2.0, 1.5, 1.0])),
} | {name: (lambda name=name: score.weld(*score.load(CLEAN / REAL[name])), None) for name in REAL}


def is_disc(faces):
    """Whether triangles that are joined over edges make a disc."""
    half = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, count = np.unique(half, axis=0, return_counts=True)
    rim = edges[count == 1]
    ends = np.unique(rim, return_counts=True)[1]
    euler = len(np.unique(faces)) - len(edges) + len(faces)
    return euler == 1 and len(rim) > 0 and (ends == 2).all()


class Hole:
    """A mesh with a hole."""

    def __init__(self, name, size, seed, folder):
        self.name, self.size, self.seed = name, size, seed
        make, place = CASES[name]
        points, faces = make()
        random = np.random.default_rng([zlib.crc32(name.encode()), round(1000 * size), seed])
        diagonal = np.linalg.norm(np.ptp(points, axis=0))
        middles = points[faces].mean(axis=1)
        half = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        edge = np.unique(np.sort(half, axis=1), axis=0, return_inverse=True)[1].ravel()
        order = np.argsort(edge, kind="stable")
        beside = np.stack([order[0::2], order[1::2]], 1) // 3
        for _ in range(1000):
            at = place(random) if place else middles[random.integers(len(faces))]
            near = np.linalg.norm(middles - at, axis=1) < size / 200 * diagonal
            first = np.argmin(np.linalg.norm(middles - at, axis=1))
            near[first] = True
            pairs = beside[near[beside].all(axis=1)]
            graph = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(faces),) * 2)
            part = connected_components(graph, directed=False)[1]
            gone = part == part[first]
            if is_disc(faces[gone]):
                break
        else:
            raise ValueError(f"{name}: no disc of {size} %")
        if name not in REAL:
            turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
            points = points @ (turn * np.sign(np.linalg.det(turn))).T
        self.points, self.faces, self.gone, self.diagonal = points, faces, gone, diagonal
        self.width = size / 100 * diagonal
        self.key = f"{name.replace(', ', '-')}-{size:g}-{seed}"
        self.path = folder / f"{self.key}.obj"
        if not self.path.exists():
            write_obj(self.path, points, faces[~gone])

    def measured(self, points, faces):
        """RMS and max in percent of the width, and what else there is to say of a result."""
        kept = self.faces[~self.gone]
        away, same = cKDTree(self.points).query(points)
        same[away > 1e-6 * self.diagonal] = -1
        known = {tuple(face[k:]) + tuple(face[:k]) for face in kept.tolist() for k in range(3)}
        new = np.array([tuple(face) not in known for face in same[faces].tolist()], bool)
        lost = len(kept) - int((~new).sum())
        removed = self.faces[self.gone]
        # Samples first, then vertices, so that one tree serves both.
        queries = np.concatenate([samples(self.points, removed), self.points[np.unique(removed)]])
        there = to(queries, points, faces)
        back = np.zeros(SAMPLES)
        if new.any():
            queries = np.concatenate([samples(points, faces[new]), points[np.unique(faces[new])]])
            back = to(queries, self.points, self.faces)
        worst = max(there.max(), back.max())
        unit = 100 / self.width
        rms = np.sqrt(((there[:SAMPLES] ** 2).mean() + (back[:SAMPLES] ** 2).mean()) / 2)
        valid = bool(score.validity(points, faces).get("valid"))
        return {"rms": float(rms * unit), "max": float(worst * unit), "valid": valid, "triangles": int(new.sum()), "lost": lost}


def samples(points, faces, count=SAMPLES, seed=1):
    random = np.random.default_rng(seed)
    a, b, c = (points[faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    face = random.choice(len(faces), count, p=area / area.sum())
    r = random.random((count, 2))
    s = np.sqrt(r[:, :1])
    return a[face] * (1 - s) + b[face] * s * (1 - r[:, 1:]) + c[face] * s * r[:, 1:]


def to(queries, points, faces):
    return np.sqrt(np.maximum(igl.point_mesh_squared_distance(queries, points, np.ascontiguousarray(faces))[0], 0))


# ---------------------------------------------------------------- who closes


class Ours:
    """The program with one style."""

    kept = False

    def __init__(self, program, style):
        self.program, self.style, self.name = program, style, style

    def close(self, hole, out):
        command = [self.program, "repair", hole.path, "-o", out, "--resolution", "256", "--fill", self.style, "--json", "-q"]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        if done.returncode:
            return {"refused": done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"exit {done.returncode}"}
        report = json.loads(done.stdout)
        holes = report["result"]["pipeline"]["holes"]
        ways = [hole.get("closed_by", "lid") for hole in holes]
        return {"way": ", ".join(way if isinstance(way, str) else " ".join(*way.items()) for way in ways) or "no hole"}


class PyMeshFix:
    kept = True

    def __init__(self):
        import pymeshfix

        self.library = pymeshfix
        self.name = f"pymeshfix {importlib.metadata.version('pymeshfix')}"

    def close(self, hole, out):
        mesh = self.library.PyTMesh()
        mesh.set_quiet(True)
        points, faces = score.load(hole.path)
        mesh.load_array(points, faces.astype(np.int32))
        mesh.fill_small_boundaries(0, True)
        points, faces = mesh.return_arrays()
        write_obj(out, np.asarray(points, float), np.asarray(faces))
        return {}


class MeshLib:
    kept = True

    def __init__(self, nicely):
        import meshlib.mrmeshnumpy as arrays
        import meshlib.mrmeshpy as library

        self.arrays, self.library, self.nicely = arrays, library, nicely
        self.name = f"MeshLib {importlib.metadata.version('meshlib')} {'fillHoleNicely' if nicely else 'fillHole'}"

    def close(self, hole, out):
        points, faces = score.load(hole.path)
        mesh = self.arrays.meshFromFacesVerts(faces.astype(np.int32), points)
        for edge in mesh.topology.findHoleRepresentiveEdges():
            if self.nicely:
                settings = self.library.FillHoleNicelySettings()
                settings.triangulateParams.metric = self.library.getUniversalMetric(mesh)
                # The longest edge of the lid as long as the mean edge of the mesh; the default is of no use in a mesh of any size.
                settings.subdivideSettings.maxEdgeLen = mesh.averageEdgeLength()
                self.library.fillHoleNicely(mesh, edge, settings)
            else:
                settings = self.library.FillHoleParams()
                settings.metric = self.library.getUniversalMetric(mesh)
                self.library.fillHole(mesh, edge, settings)
        points, faces = self.arrays.getNumpyVerts(mesh), self.arrays.getNumpyFaces(mesh.topology)
        write_obj(out, np.asarray(points, float), np.asarray(faces))
        return {}


class Cgal:
    kept = True

    def __init__(self, folder):
        compiler, self.program = shutil.which("g++"), folder / "holes_cgal"
        if compiler is None:
            raise ImportError("g++ is missing")
        source = ROOT / "tools/holes_cgal.cpp"
        if not self.program.exists() or self.program.stat().st_mtime < source.stat().st_mtime:
            words = [compiler, "-O2", "-DNDEBUG", "-I/usr/include/eigen3", "-DCGAL_EIGEN3_ENABLED", source, "-o", self.program, "-lgmp", "-lmpfr"]
            done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
            if done.returncode:
                raise ImportError(done.stderr.strip().splitlines()[0])
        self.name = "CGAL refine and fair"

    def close(self, hole, out):
        done = subprocess.run([self.program, hole.path, out], capture_output=True, text=True, timeout=300)
        return {} if done.returncode == 0 else {"refused": f"exit {done.returncode}"}


def peers(folder):
    found = []
    for make in (PyMeshFix, lambda: MeshLib(False), lambda: MeshLib(True), lambda: Cgal(folder)):
        try:
            found.append(make())
        except ImportError as missing:
            print(f"left out: {missing}", file=sys.stderr)
    return found


def result(method, hole, folder):
    """What a method makes of a hole, measured."""
    name = hashlib.sha1(f"{method.name} {hole.key} {hole.path.read_bytes()}".encode()).hexdigest()[:16]
    kept = folder / f"{name}.json"
    if method.kept and kept.exists():
        return json.loads(kept.read_text())
    out = folder / f"{hole.key}-{method.name.split()[-1]}.obj"
    out.unlink(missing_ok=True)
    start = time.perf_counter()
    said = method.close(hole, out)
    said["seconds"] = time.perf_counter() - start
    if "refused" not in said:
        said |= hole.measured(*score.load(out))
    if method.kept:
        kept.write_text(json.dumps(said))
    return said


# ---------------------------------------------------------------- tables


def line(words):
    print("| " + " | ".join(words) + " |", flush=True)


def summary(found):
    good = [r for r in found if "rms" in r]
    if not good:
        return "–"
    text = f"{np.mean([r['rms'] for r in good]):.2f}, {np.mean([r['max'] for r in good]):.1f}"
    bad = sum(not r.get("valid") for r in found)
    return text + (f" ({bad} bad)" if bad else "")


def accuracy(args, folder):
    methods = [Ours(args.program, style) for style in args.styles.split(",")]
    if args.peers:
        methods += peers(folder)
    sizes = [float(size) for size in args.sizes.split(",")]
    found = {}
    for name in (name for name in CASES if args.only in name):
        for size in sizes:
            for seed in range(1, args.seeds + 1):
                hole = Hole(name, size, seed, folder)
                for method in methods:
                    said = result(method, hole, folder)
                    found[name, size, seed, method.name] = said
                    if args.each:
                        print(hole.key, method.name, {k: round(v, 4) if isinstance(v, float) else v for k, v in said.items()}, flush=True)
    names = [method.name for method in methods]
    table("hole", [(name, lambda key, name=name: key[0] == name) for name in CASES if args.only in name], names, found)
    table("width", [(f"{size:g} %", lambda key, size=size: key[1] == size) for size in sizes], names, found)
    if args.json:
        rows = [{"case": k[0], "size": k[1], "seed": k[2], "method": k[3]} | said for k, said in found.items()]
        args.json.write_text(json.dumps(rows, indent=0))


def table(title, rows, names, found):
    line([title] + names)
    print("|---" * (len(names) + 1) + "|")
    for label, chosen in rows + [("all", lambda key: True)]:
        line([label] + [summary([said for key, said in found.items() if chosen(key) and key[3] == name]) for name in names])
    print()


def many_holes(count, random):
    """A wavy sheet closed to a slab, with so many round holes in its top."""
    side = 128
    x, y = np.meshgrid(np.linspace(0, 1, side + 1), np.linspace(0, 1, side + 1), indexing="ij")
    z = 0.05 + 0.01 * np.sin(9 * x) * np.cos(7 * y)
    top = np.stack([x, y, z], 2)
    frame = [top[0, ::-1], top[-1], top[:, 0], top[::-1, -1]]
    walls = [sheet(np.stack([edge, edge * [1, 1, 0]])) for edge in frame]
    low = sheet(top[::-1] * [1, 1, 0])
    points, faces = sheet(top)
    across = int(np.ceil(np.sqrt(count)))
    cells = random.permutation(across * across)[:count]
    at = (np.stack([cells // across, cells % across], 1) + 0.5) / across
    gone = cKDTree(at).query(points[faces].mean(axis=1)[:, :2])[0] < 0.008
    return facing_out(joined([(points, faces[~gone]), low, *walls]))


def times(args, folder):
    """Seconds over the number of holes, on a mesh that is otherwise the same."""
    line(["holes", "triangles", "holes closed by lids", "s", "fill, s"])
    print("|---|---|---|---|---|")
    for count in (1, 10, 100, 300, 1000):
        path, out = folder / f"many-{count}.obj", folder / "many.obj"
        points, faces = many_holes(count, np.random.default_rng(count))
        write_obj(path, points, faces)
        command = [args.program, "repair", path, "-o", out, "--json", "-q"]
        start = time.perf_counter()
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        whole = time.perf_counter() - start
        report = json.loads(done.stdout)
        lids = sum("lid" in hole["closed_by"] for hole in report["result"]["pipeline"]["holes"])
        fill = sum(stage["seconds"] for stage in report["stages"] if stage["stage"] == "fill")
        line([f"{count:,}", f"{len(faces):,}", f"{lids:,}", f"{whole:.2f}", f"{fill:.3f}"])


def random_soup(random):
    """A ball, a box or a torus without random parts, and with random triangles, turned triangles or a shell inside; seldom nothing but random triangles."""
    kind = random.integers(5)
    if kind == 4:
        count = random.integers(4, 40)
        points = random.integers(0, 4, (count, 3)).astype(float)
        return points, random.integers(0, count, (count, 3))
    points, faces = [lambda: sphere(2), lambda: box((1, 1, 1), 0.25), lambda: torus(2, 0.8, 16, 8), lambda: cylinder(12, 4)][kind]()
    middles = points[faces].mean(axis=1)
    keep = np.ones(len(faces), bool)
    for _ in range(random.integers(1, 6)):
        at = middles[random.integers(len(faces))]
        keep &= np.linalg.norm(middles - at, axis=1) > random.uniform(0, 0.5)
    keep &= random.random(len(faces)) > random.choice([0, 0.02, 0.2])
    kept = faces[keep]
    turned = random.random(len(kept)) < random.choice([0, 0, 0.1])
    kept[turned] = kept[turned][:, ::-1]
    if random.random() < 0.3:
        points = points + random.normal(size=points.shape) * random.choice([1e-9, 0.01, 0.1])
    if random.random() < 0.2:
        points, kept = np.concatenate([points, points * 0.5]), np.concatenate([kept, kept[:, ::-1] + len(points)])
    return points, kept


def soups(args, folder):
    """Random soups with holes: each becomes a valid solid, or is refused with a reason."""
    found = {"valid": 0, "refused": 0}
    reasons, wrong = {}, []
    for seed in range(args.soups):
        path, out = folder / "soup.obj", folder / "soup-out.obj"
        out.unlink(missing_ok=True)
        points, faces = random_soup(np.random.default_rng([17, seed]))
        write_obj(path, points, faces)
        command = [args.program, "repair", path, "-o", out, "--resolution", "32", "-q"]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=300)
        said = done.stderr.strip().splitlines()
        if out.exists() and score.validity(*score.load(out)).get("valid"):
            found["valid"] += 1
        elif not out.exists() and done.returncode > 0 and said and "panicked" not in done.stderr:
            found["refused"] += 1
            reasons[said[0][:100]] = reasons.get(said[0][:100], 0) + 1
        else:
            wrong.append(seed)
            shutil.copy(path, folder / f"wrong-soup-{seed}.obj")
    print(f"{args.soups} soups: {found['valid']} valid, {found['refused']} refused, wrong: {wrong or 'none'}")
    for reason, count in sorted(reasons.items(), key=lambda entry: -entry[1]):
        print(f"  {count} times: {reason}")
    sys.exit(1 if wrong else 0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--peers", action="store_true", help="beside pymeshfix, MeshLib and CGAL, where they are installed")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--sizes", default="2,5,10,20", help="widths of holes, in percent of the diagonal")
    parser.add_argument("--styles", default="auto,flat,smooth")
    parser.add_argument("--only", default="", metavar="WORD", help="holes with this word in their name")
    parser.add_argument("--times", action="store_true", help="seconds over the number of holes")
    parser.add_argument("--soups", type=int, default=0, metavar="N", help="random soups with holes")
    parser.add_argument("--each", action="store_true", help="a line for each result")
    parser.add_argument("--json", type=Path, help="where to write all results")
    args = parser.parse_args()
    folder = Path(tempfile.gettempdir()) / "meshwright-holes"
    folder.mkdir(exist_ok=True)
    if args.times:
        times(args, folder)
    elif args.soups:
        soups(args, folder)
    else:
        accuracy(args, folder)


if __name__ == "__main__":
    main()
