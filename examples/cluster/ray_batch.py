"""Repairs a folder of meshes by Ray: the same as `dask_batch.py`, whose function it maps, with a table in JSON lines.

    python examples/cluster/ray_batch.py IN OUT [--address auto] [--resolution 256]

Without an address Ray starts on this machine.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from dask_batch import EXTENSIONS, repair  # noqa: E402


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", metavar="IN", type=Path)
    parser.add_argument("out", metavar="OUT", type=Path)
    parser.add_argument("--address", help="address of a cluster, or `auto`")
    parser.add_argument("--resolution", type=int, default=256)
    given = parser.parse_args()

    import ray

    ray.init(address=given.address, include_dashboard=False, runtime_env={"env_vars": {"PYTHONPATH": str(Path(__file__).parent.resolve())}})
    folder, out = given.folder.resolve(), given.out.resolve()
    files = sorted((p for p in folder.rglob("*") if p.suffix.lower() in EXTENSIONS), key=lambda p: p.stat().st_size, reverse=True)
    # A task that kills its worker is given to another one, twice.
    task = ray.remote(num_cpus=1, max_retries=2)(repair)
    options = {"resolution": given.resolution, "threads": 1}
    waiting = {task.remote(str(path), str(out / path.relative_to(folder)), options): path for path in files}
    out.mkdir(parents=True, exist_ok=True)
    with open(out / "reports.jsonl", "w") as table:
        while waiting:
            (done,), _ = ray.wait(list(waiting))
            path = waiting.pop(done)
            try:
                row = ray.get(done)
            except ray.exceptions.RayError as error:
                row = {"input": str(path), "class": type(error).__name__, "message": str(error).splitlines()[0]}
            print(json.dumps(row), file=table, flush=True)
            print(f"{row['class']}: {row['input']}", flush=True)
    ray.shutdown()


if __name__ == "__main__":
    main()
