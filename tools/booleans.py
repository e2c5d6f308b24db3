#!/usr/bin/env python3
"""All three booleans on every pair of ../shared/eval/pairs.py, against manifold3d's exact result.

    tools/booleans.py PROGRAM [--resolution 256] [--only WORD]

Needs the packages of ../shared/eval/requirements.txt. Where manifold3d refuses an operand, only validity is judged.
"""
import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
EVAL = ROOT.parent / "shared" / "eval"
sys.path.insert(0, str(EVAL))
import score  # noqa: E402


def longest(*meshes):
    used = np.concatenate([vertices[np.unique(faces)] for vertices, faces in meshes])
    return float((used.max(0) - used.min(0)).max())


def number(value, digits):
    return "" if value is None else f"{value:.{digits}g}"


def row(program, a_path, b_path, operation, resolution, out):
    """Cells of one line of the table."""
    out.unlink(missing_ok=True)
    # What the program itself says is mostly lost is measured, too.
    done = subprocess.run([program, operation, a_path, b_path, "-o", out, "--resolution", str(resolution), "--keep-partial"],
                          capture_output=True, text=True)
    if not out.exists():
        last = done.stderr.strip().splitlines()
        return [str(done.returncode), "", "", "", "", "", last[0] if last else ""]
    a, b = score.load(a_path), score.load(b_path)
    report = score.score_boolean(a, b, operation, score.load(out), longest(a, b) / resolution, 20_000)
    near, edge = report.get("fidelity") or {}, report.get("sharp") or {}
    both = (near.get("symmetric") or {}).get("h") or {}
    return [str(done.returncode), str(report["validity"]["valid"]), str(report["validity"]["components"]),
            number(near.get("volume_rel_error"), 2), number(both.get("mean"), 2), number(both.get("max"), 2),
            number(edge.get("edge_recall"), 4) or report["reference"]]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--resolution", type=int, default=256)
    parser.add_argument("--only", default="")
    args = parser.parse_args()
    print("| pair | operation | exit | valid | bodies | volume error | mean h | max h | edge recall or remark |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        names = subprocess.run([sys.executable, EVAL / "pairs.py", folder], check=True, capture_output=True, text=True)
        for name in names.stdout.split():
            for operation in ("union", "intersection", "difference"):
                if args.only in f"{name} {operation}":
                    cells = row(args.program.resolve(), folder / f"{name}_a.obj", folder / f"{name}_b.obj", operation,
                                args.resolution, folder / "out.obj")
                    print(f"| {name} | {operation} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
