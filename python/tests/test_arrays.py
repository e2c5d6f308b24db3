"""Arrays of every type go in, and come back as they were where they were right."""

from __future__ import annotations

import resource
import subprocess
import sys

import numpy as np
import pytest
from conftest import cube, quads

import meshwright as mw


@pytest.mark.parametrize("number", [np.float32, np.float64])
@pytest.mark.parametrize("index", [np.int8, np.uint16, np.int32, np.uint32, np.int64, np.uint64])
def test_types(number: type, index: type) -> None:
    vertices, faces = cube()
    made = mw.repair((vertices.astype(number), faces.astype(index)))
    assert made.vertices.dtype == np.float64 and made.faces.dtype == np.uint32
    # A valid solid comes back as it was.
    assert np.array_equal(made.vertices, vertices) and np.array_equal(made.faces, faces)
    assert np.array_equal(made.sources, np.column_stack([np.zeros(12), np.arange(12)]))
    assert set(made.kinds.tolist()) == {mw.KINDS.index("kept")}


@pytest.mark.parametrize("order", ["C", "F"])
def test_orders_and_views(order: str) -> None:
    vertices, faces = cube()
    wide = np.zeros((16, 6))
    wide[::2, ::2] = vertices
    made = mw.repair((np.array(wide[::2, ::2], order=order), np.array(faces, order=order)))
    assert np.array_equal(made.vertices, vertices)
    assert np.array_equal(mw.repair((wide[::2, ::2], faces)).vertices, vertices)


def test_lists_and_squares() -> None:
    vertices, faces = cube()
    assert mw.repair((vertices.tolist(), faces.tolist())).volume == 1.0
    assert mw.repair(quads()).volume == 1.0


def test_what_is_no_mesh() -> None:
    vertices, faces = cube()
    for bad in [(vertices[:, :2], faces), (vertices, faces.astype(float)), (vertices.astype(object), faces)]:
        with pytest.raises(mw.BadArray):
            mw.repair(bad)
    with pytest.raises(mw.BadArray, match="vertex 7"):
        mw.repair((vertices[:7], faces))
    with pytest.raises(mw.BadArray, match="negative"):
        mw.repair((vertices, faces - 1))
    with pytest.raises(mw.UsageError, match="no mesh"):
        mw.repair(3)


def test_what_is_no_number_is_left_out_with_a_word() -> None:
    vertices, faces = cube()
    vertices = np.vstack([vertices, [np.nan, 0, 0]])
    with pytest.warns(mw.MeshwrightWarning, match="no finite number"):
        made = mw.repair((vertices, np.vstack([faces, [0, 1, 8]])))
    assert made.volume == 1.0


def test_points() -> None:
    mesh = cube(2.0)
    found = mw.closest_point(mesh, [[1, 1, 5], [1, 1, 1.5]])
    assert found.points.tolist() == [[1, 1, 2], [1, 1, 2]] and found.distances.tolist() == [3, 0.5]
    assert mw.signed_distance(mesh, np.array([[1, 1, 5], [1, 1, 1.5]], np.float32)).tolist() == [3, -0.5]
    inside = np.random.default_rng(0).uniform(-1, 3, (1000, 3))
    assert np.array_equal(mw.contains(mesh, inside), ((inside > 0) & (inside < 2)).all(axis=1))
    # Without a side: where the winding number is above a half.
    open_box = (mesh[0], mesh[1][2:])
    assert mw.contains(open_box, [[1, 1, 1], [5, 1, 1]]).tolist() == [True, False]


def test_sdf_is_the_distance() -> None:
    grid = mw.sdf(cube(), resolution=16, band="full")
    x, y, z = grid.axes()
    places = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1)
    d = np.abs(places - 0.5) - 0.5
    truth = np.linalg.norm(np.maximum(d, 0), axis=-1) + np.minimum(d.max(axis=-1), 0)
    assert np.abs(grid.values - truth).max() < 1e-6


def test_planes_joined_are_the_whole() -> None:
    mesh = mw.read("testdata/broken_mug.obj")
    whole = mw.sdf(mesh, resolution=40)
    count = mw.plan("sdf", mesh, resolution=40)["dims"][2]
    parts = [mw.sdf(mesh, resolution=40, planes=(low, min(low + 16, count))) for low in range(0, count, 16)]
    assert whole.values.shape[2] == count
    assert np.array_equal(np.concatenate([part.values for part in parts], axis=2), whole.values)
    with pytest.raises(mw.UsageError):
        mw.sdf(mesh, resolution=40, planes=(3, 8))


def test_grids_are_written(tmp_path, run) -> None:
    mesh = mw.repair("testdata/hollow_ball.stl", resolution=32)
    mesh.write(tmp_path / "ball.ply")
    grid = mw.sdf(tmp_path / "ball.ply", resolution=32)
    for name in ("a.vti", "a.nrrd", "a.npy"):
        grid.write(tmp_path / name)
        run("sdf", tmp_path / "ball.ply", "-o", tmp_path / f"b{name[1:]}", "--resolution", 32)
        assert (tmp_path / name).read_bytes() == (tmp_path / f"b{name[1:]}").read_bytes(), name
    assert np.array_equal(np.load(tmp_path / "a.npy"), grid.values)
    with pytest.raises(mw.UsageError):
        grid.write(tmp_path / "a.stl")


MEMORY = """
import resource, numpy as np, meshwright as mw
n = 1000
x, y = np.meshgrid(np.arange(n, dtype=float), np.arange(n, dtype=float), indexing="ij")
vertices = np.stack([x, y, np.zeros_like(x)], -1).reshape(-1, 3)
i = np.arange(n * n).reshape(n, n)
a, b, c, d = (i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:])
faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]).astype(np.uint32)
warm = mw.closest_point(([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), [[0, 0, 1]])
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
try:
    mw.repair((vertices, faces[:0]))
except mw.Error:
    pass
after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
print((after - before) / vertices.nbytes)
"""


def test_arrays_are_copied_once() -> None:
    """Where nothing is done with the mesh, what a call takes is one copy of its arrays."""
    told = subprocess.run([sys.executable, "-c", MEMORY], capture_output=True, text=True, check=True)
    assert float(told.stdout) < 1.6, told.stdout


def test_a_hundred_calls_leave_no_memory_behind() -> None:
    mesh = mw.repair("testdata/broken_mug.obj", resolution=32)
    for _ in range(10):
        mw.repair(mesh, resolution=32)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(60):
        mw.repair(mesh, resolution=32)
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert after - before < 30_000, f"{after - before} KB more"
