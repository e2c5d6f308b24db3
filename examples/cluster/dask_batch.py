"""Repairs a folder of meshes on a Dask cluster, and writes the reports as one Parquet file.

    python examples/cluster/dask_batch.py IN OUT [--scheduler ADDRESS] [--workers 2] [--resolution 256]

Without the address of a scheduler a cluster of workers on this machine does it. IN and OUT are seen by all workers under the same names. A worker that
is killed loses nothing: its files are given to another one, and each output gets its name only when it is whole.
"""

from __future__ import annotations

import argparse
import hashlib
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

COLUMNS = ["input", "output", "class", "message", "sha256", "seconds", "triangles", "volume", "made_up", "warnings"]
EXTENSIONS = {".stl", ".obj", ".ply", ".off", ".glb", ".gltf", ".3mf"}


def repair(source: str, target: str, options: dict[str, Any]) -> dict[str, Any]:
    """Repairs one file, on a worker. Returns a row of the table."""
    import meshwright as mw

    row: dict[str, Any] = {"input": source, "output": None, "class": "done", "message": None}
    Path(target).parent.mkdir(parents=True, exist_ok=True)
    try:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always", mw.MeshwrightWarning)
            mesh = mw.repair(source, out_format=Path(target).suffix[1:], **options)
            mesh.write(target)
    except mw.Error as error:
        return {**row, "class": type(error).__name__, "message": error.message}
    return {
        **row,
        "output": target,
        "sha256": hashlib.sha256(Path(target).read_bytes()).hexdigest(),
        "seconds": mesh.report["seconds"],
        "triangles": len(mesh.faces),
        "volume": mesh.volume,
        "made_up": int((mesh.kinds == mw.KINDS.index("made up")).sum()) if mesh.kinds is not None else 0,
        "warnings": [str(one.message) for one in said],
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", metavar="IN", type=Path)
    parser.add_argument("out", metavar="OUT", type=Path)
    parser.add_argument("--scheduler", help="address of a scheduler, such as tcp://host:8786")
    parser.add_argument("--workers", type=int, default=2, help="workers on this machine, without a scheduler")
    parser.add_argument("--resolution", type=int, default=256)
    given = parser.parse_args()

    import pyarrow
    import pyarrow.parquet
    from dask.distributed import Client, LocalCluster, as_completed

    folder = given.folder.resolve()
    files = sorted(path for path in folder.rglob("*") if path.suffix.lower() in EXTENSIONS)
    # The largest first, so that none of them is left for the end.
    files.sort(key=lambda path: path.stat().st_size, reverse=True)
    out = given.out.resolve()
    cluster = None if given.scheduler else LocalCluster(n_workers=given.workers, threads_per_worker=1, dashboard_address=None)
    with Client(given.scheduler or cluster) as client:
        options = {"resolution": given.resolution, "threads": 1}
        # What kills its worker three times is at fault itself.
        tasks = [
            client.submit(repair, str(path), str(out / path.relative_to(folder)), options, key=f"repair-{path.relative_to(folder)}", retries=2)
            for path in files
        ]
        rows = []
        for task in as_completed(tasks):
            try:
                rows.append(task.result())
            except Exception as error:  # a worker that died, or a fault of the machine
                rows.append({"input": task.key.removeprefix("repair-"), "class": type(error).__name__, "message": str(error)})
            print(f"{len(rows)} of {len(files)}: {rows[-1]['class']}: {rows[-1]['input']}", flush=True)
    if cluster:
        cluster.close()
    rows = [{name: row.get(name) for name in COLUMNS} for row in sorted(rows, key=lambda row: row["input"])]
    out.mkdir(parents=True, exist_ok=True)
    pyarrow.parquet.write_table(pyarrow.Table.from_pylist(rows), out / "reports.parquet")
    for kind, count in sorted(Counter(row["class"] for row in rows).items()):
        print(f"{kind}: {count}")


if __name__ == "__main__":
    main()
