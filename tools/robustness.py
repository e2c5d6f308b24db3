#!/usr/bin/env python3
"""Break clean meshes in known ways, repair them, and compare with the truth: the table of docs/robustness.md.

    tools/robustness.py PROGRAM [--resolution 128] [--seeds 3] [--only WORD]

Needs the packages of ../shared/eval/requirements.txt. Volume within 1 % of the clean mesh is wanted, 3 % for
kinds that open holes.
"""
import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
EVAL = ROOT.parent / "shared" / "eval"
DATA = ROOT.parent / "shared" / "data"
sys.path.insert(0, str(EVAL))
import damage  # noqa: E402
import score  # noqa: E402

MESHES = ["clean/fandisk.off", "clean/520644.stl", "clean/rocker-arm.obj"]
SMALL = {"cracks": 0.001, "noise": 0.001}
WIDE = {"holes", "mixed"}


def volume(path):
    return score.validity(*score.load(path), check_intersections=False)["volume"]


def run(program, mesh, kind, seed, resolution, folder):
    """(status, valid, relative volume error) of one case."""
    broken, out = folder / "broken.stl", folder / "out.obj"
    out.unlink(missing_ok=True)
    amount = SMALL.get(kind, 0.02)
    subprocess.run([sys.executable, EVAL / "damage.py", mesh, broken, "--kind", kind, "--amount", str(amount),
                    "--seed", str(seed)], check=True, capture_output=True)
    # What the program itself says is mostly lost is measured, too.
    done = subprocess.run([program, "repair", broken, "-o", out, "--resolution", str(resolution), "--keep-partial", "-q"],
                          capture_output=True)
    if not out.exists():
        return done.returncode, False, None
    report = score.validity(*score.load(out))
    return done.returncode, report["valid"], report["volume"] / volume(mesh) - 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--resolution", type=int, default=128)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--only", default="")
    args = parser.parse_args()
    seeds = range(1, args.seeds + 1)
    print("| mesh | damage | " + " | ".join(f"seed {s}" for s in seeds) + " | verdict |")
    print("|---|---|" + "---|" * (args.seeds + 1))
    misses = cases = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in MESHES:
            for kind in damage.KINDS:
                if args.only not in f"{name} {kind}":
                    continue
                cells, right = [], True
                for seed in seeds:
                    status, valid, error = run(args.program.resolve(), DATA / name, kind, seed, args.resolution, Path(folder))
                    bound = 0.03 if kind in WIDE else 0.01
                    fine = valid and error is not None and abs(error) <= bound
                    cells.append(f"exit {status}" if error is None else f"{100 * error:+.3f} %" + ("" if valid else " invalid"))
                    right &= fine
                    cases += 1
                    misses += not fine
                print(f"| {name} | {kind} | " + " | ".join(cells) + f" | {'right' if right else 'MISS'} |", flush=True)
    print(f"\n{cases - misses} of {cases} cases right.")
    return 1 if misses else 0


if __name__ == "__main__":
    sys.exit(main())
