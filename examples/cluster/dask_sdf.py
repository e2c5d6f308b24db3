"""Makes the signed distance of one mesh slab by slab on a Dask cluster, and puts it into one Zarr array.

    python examples/cluster/dask_sdf.py MESH OUT.zarr [--resolution 1024] [--planes 128] [--band 4h] [--scheduler ADDRESS]

A worker holds the mesh and one slab of planes, not the lattice. The values are those of `meshwright sdf` in one run, to the last bit. OUT.zarr is indexed
`[x, y, z]`, and its attributes say where the lattice lies. MESH and OUT.zarr are seen by all workers under the same names.
"""

from __future__ import annotations

import argparse
from typing import Any


def slab(mesh: str, out: str, planes: tuple[int, int], options: dict[str, Any]) -> int:
    """Makes and stores some planes, on a worker. Returns how many voxels lie inside."""
    import meshwright as mw
    import zarr

    grid = mw.sdf(mesh, planes=planes, **options)
    zarr.open_array(out, mode="r+")[:, :, planes[0] : planes[1]] = grid.values
    return int((grid.values < 0).sum())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", metavar="MESH")
    parser.add_argument("out", metavar="OUT.zarr")
    parser.add_argument("--resolution", type=int, default=1024)
    parser.add_argument("--planes", type=int, default=128, help="planes of a slab, a multiple of 8")
    parser.add_argument("--band", default="4h")
    parser.add_argument("--scheduler", help="address of a scheduler, such as tcp://host:8786")
    parser.add_argument("--workers", type=int, default=2, help="workers on this machine, without a scheduler")
    given = parser.parse_args()

    import meshwright as mw
    import numpy as np
    import zarr
    from dask.distributed import Client, LocalCluster

    options = {"resolution": given.resolution, "band": given.band}
    whole = mw.plan("sdf", given.mesh, **options)
    x, y, z = whole["dims"]
    # One slab says where the lattice lies.
    first = mw.sdf(given.mesh, planes=(0, min(8, z)), **options)
    array = zarr.create_array(given.out, shape=(x, y, z), chunks=(min(x, 128), min(y, 128), given.planes), dtype=np.float32, overwrite=True)
    array.attrs.update({"origin": list(first.origin), "spacing": first.spacing, "band": first.band, "unit": first.unit})
    cluster = None if given.scheduler else LocalCluster(n_workers=given.workers, threads_per_worker=1, dashboard_address=None)
    with Client(given.scheduler or cluster) as client:
        slabs = [(low, min(low + given.planes, z)) for low in range(0, z, given.planes)]
        tasks = [client.submit(slab, given.mesh, given.out, planes, options, retries=2, pure=False) for planes in slabs]
        inside = sum(client.gather(tasks))
    if cluster:
        cluster.close()
    print(f"{x} x {y} x {z} values in {len(slabs)} slabs, {inside} inside")


if __name__ == "__main__":
    main()
