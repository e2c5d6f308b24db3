"""What a user writes, for `mypy --strict`: it is checked and not run."""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

import meshwright as mw


def repaired(path: str) -> mw.Mesh:
    mesh = mw.repair(path, resolution=128, method="auto", drop_smaller="8h3", progress=True)
    kinds: NDArray[np.uint8] | None = mesh.kinds
    assert kinds is not None
    mesh.write("out.3mf", unit="mm")
    return mesh


def combined(a: trimesh.Trimesh, b: tuple[NDArray[np.float64], NDArray[np.int64]]) -> trimesh.Trimesh:
    return mw.difference(a, b, voxel="0.2mm").to_trimesh()


def sampled(mesh: mw.Mesh) -> NDArray[np.float32]:
    return mw.sdf(mesh, band="full", resolution=64).values


def listed(mesh: mw.Mesh) -> tuple[list[dict[str, Any]], mw.Mesh | None]:
    try:
        return mw.canals(mesh, max_diameter=2.0, remove=[1, 2])
    except mw.NothingEnclosed as error:
        reason: str | None = error.reason
        raise SystemExit(reason) from error


def followed(mesh: mw.Mesh) -> mw.Mesh:
    def hear(stage: str, share: float) -> None:
        print(stage, share)

    return mw.csg("a - b", {"a": mesh, "b": "hole.stl"}, progress=hear)


def asked(mesh: mw.Mesh, points: NDArray[np.float64]) -> NDArray[np.bool_]:
    found: mw.ClosestPoints = mw.closest_point(mesh, points)
    assert found.distances.shape == (len(points),)
    return mw.contains(mesh, points)
