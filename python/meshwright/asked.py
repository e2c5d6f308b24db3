"""Questions about meshes and points, and files: what no verb of the command line answers by itself."""

from __future__ import annotations

import os
import warnings
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._call import call
from ._given import MeshLike, as_given, as_points
from ._made import Grid, Mesh
from .errors import MeshwrightWarning, failure

__all__ = ["ClosestPoints", "closest_point", "contains", "plan", "read", "signed_distance", "write"]


class ClosestPoints(NamedTuple):
    """What of a mesh is nearest to points."""

    #: The nearest points of the surface, model units: float64, shape (n, 3).
    points: NDArray[np.float64]
    #: How far they are, model units: float64, shape (n,).
    distances: NDArray[np.float64]
    #: The triangles they lie on: int64, shape (n,).
    faces: NDArray[np.int64]


def read(path: str | os.PathLike[str], *, in_format: str | None = None) -> Mesh:
    """Reads a mesh: STL, OBJ, PLY, OFF, glTF, GLB or 3MF. Nothing is repaired.

    >>> import meshwright as mw
    >>> mw.read("testdata/hollow_ball.stl").faces.shape[1]
    3
    """
    failed, mesh, notes = _native.read(os.fspath(path), in_format)
    if failed is not None:
        raise failure(failed)
    for sentence in notes:
        warnings.warn(sentence, MeshwrightWarning, stacklevel=2)
    mesh.pop("kind")
    return Mesh._of(mesh, {})


def write(
    mesh: MeshLike | Grid,
    path: str | os.PathLike[str],
    *,
    out_format: str | None = None,
    ascii: bool = False,
    unit: str | None = None,
    keep_partial: bool = False,
) -> dict[str, Any]:
    """Writes a mesh (STL, OBJ, PLY, OFF, glTF, GLB, 3MF) or a lattice (VTI, NRRD, NPY, VDB), as the name says. The file is read back and compared before
    it gets its name. Returns the report.

    >>> import meshwright as mw, tempfile, os
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     report = mw.write(mw.repair("testdata/broken_mug.obj", resolution=64), os.path.join(folder, "mug.3mf"))
    >>> report["result"]["output"]["format"]
    '3mf'
    """
    if isinstance(mesh, Grid):
        mesh.write(path, out_format=out_format)
        return {}
    options = {"output": os.fspath(path), "out_format": out_format, "ascii": ascii, "unit": unit, "keep_partial": keep_partial}
    # What is written may take the place of what was read: it is in memory.
    _, report = call("convert", [mesh], {**options, "force": True}, result=None)
    return report


def plan(verb: str, *meshes: MeshLike, **options: Any) -> dict[str, Any]:
    """What a call would cost, without doing it: the lattice, memory in bytes, seconds on one core. ``verb`` is the name of a function that makes solids, or
    ``"sdf"``; the options are those of the function.

    >>> import meshwright as mw
    >>> mw.plan("sdf", "testdata/hollow_ball.stl", resolution=64)["dims"]
    [78, 78, 78]
    """
    _, report = call(verb, list(meshes), {**options, "plan": True}, result=None)
    return dict(report["result"]["plan"])


def contains(mesh: MeshLike, points: ArrayLike, *, threads: int | None = None) -> NDArray[np.bool_]:
    """Whether points lie inside: by the nearest triangle of a valid solid, by the winding number of any other mesh.

    ``points``: shape (n, 3), model units. Returns booleans, shape (n,).

    >>> import meshwright as mw
    >>> cube = mw.thicken(([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]]), base=1)
    >>> mw.contains(cube, [[0.5, 0.5, -0.5], [0.5, 0.5, 0.5]]).tolist()
    [True, False]
    """
    return signed_distance(mesh, points, threads=threads) < 0.0


def signed_distance(mesh: MeshLike, points: ArrayLike, *, threads: int | None = None) -> NDArray[np.float64]:
    """The distance of points from the surface, negative inside.

    ``points``: shape (n, 3), model units. Returns float64, shape (n,), model units.

    >>> import meshwright as mw
    >>> cube = mw.thicken(([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]]), base=1)
    >>> mw.signed_distance(cube, [[0.5, 0.5, -0.25], [0.5, 0.5, 3]]).tolist()
    [-0.25, 3.0]
    """
    signed, _, _ = _nearest(mesh, points, threads)
    return signed


def closest_point(mesh: MeshLike, points: ArrayLike, *, threads: int | None = None) -> ClosestPoints:
    """The points of the surface that are nearest to points.

    ``points``: shape (n, 3), model units.

    >>> import meshwright as mw
    >>> triangle = ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> found = mw.closest_point(triangle, [[0.25, 0.25, 2]])
    >>> found.points.tolist(), found.distances.tolist(), found.faces.tolist()
    ([[0.25, 0.25, 0.0]], [2.0], [0])
    """
    signed, places, faces = _nearest(mesh, points, threads)
    return ClosestPoints(places, np.abs(signed), faces)


def _nearest(mesh: MeshLike, points: ArrayLike, threads: int | None) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    given = as_given(mesh if not isinstance(mesh, (str, os.PathLike)) else read(mesh), "the mesh")
    assert isinstance(given, dict)
    failed, found = _native.nearest(given, as_points(points), threads)
    if failed is not None:
        raise failure(failed)
    return found
