"""Meshes of trimesh, PyVista, Open3D and meshio, there and back; each is skipped where it is not installed."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import cube

import meshwright as mw


def test_trimesh_and_back() -> None:
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box()
    box.visual.face_colors = np.arange(48, dtype=np.uint8).reshape(12, 4) | np.array([0, 0, 0, 255], np.uint8)
    box.units = "millimeters"
    made = mw.repair(box)
    assert made.unit == "mm" and np.array_equal(made.colours.rgba, box.visual.face_colors)
    back = made.to_trimesh()
    assert back.is_watertight and back.volume == pytest.approx(1) and np.array_equal(back.faces, box.faces)
    assert np.array_equal(back.visual.face_colors, box.visual.face_colors)
    ball = trimesh.creation.icosphere(2, 0.6)
    both = mw.difference(box, ball).to_trimesh()
    assert both.is_watertight and 0 < both.volume < 1
    scene = trimesh.Scene([box, trimesh.creation.box(transform=trimesh.transformations.translation_matrix([3, 0, 0]))])
    assert mw.repair(scene).volume == pytest.approx(2)


def test_pyvista_and_back() -> None:
    pyvista = pytest.importorskip("pyvista")
    pyvista.OFF_SCREEN = True
    for surface in (pyvista.Cube(), pyvista.Cube().triangulate(), pyvista.Sphere(), pyvista.Cylinder()):
        closed = surface.clean()
        made = mw.repair(closed)
        assert made.volume == pytest.approx(closed.triangulate().volume, rel=1e-6)
        assert made.to_pyvista().is_manifold and "kinds" in made.to_pyvista().cell_data
    grid = mw.sdf(pyvista.Sphere(), resolution=16).to_pyvista()
    assert grid["distance"].min() < 0 < grid["distance"].max()
    # The lattice is where the values are: the level 0 is the sphere.
    level = grid.contour([0.0], scalars="distance")
    assert np.linalg.norm(level.points, axis=1) == pytest.approx(0.5, abs=0.03)


def test_pyvista_accessor() -> None:
    pyvista = pytest.importorskip("pyvista", minversion="0.48")
    ball = pyvista.Sphere()
    made = ball.meshwright.repair()
    assert isinstance(made, pyvista.PolyData) and made.is_manifold
    assert made.meshwright.union(pyvista.Cube().triangulate().clean()).volume > made.volume
    assert isinstance(ball.meshwright.sdf(resolution=16), pyvista.ImageData)
    assert ball.meshwright.compare(made)["symmetric"]["max"] < 1e-6


def test_open3d_and_back() -> None:
    open3d = pytest.importorskip("open3d", exc_type=ImportError)
    box = open3d.geometry.TriangleMesh.create_box()
    made = mw.repair(box)
    assert made.volume == pytest.approx(1)
    assert made.to_open3d().is_watertight()


def test_meshio() -> None:
    meshio = pytest.importorskip("meshio")
    vertices, faces = cube()
    assert mw.repair(meshio.Mesh(vertices, [("triangle", faces)])).volume == 1


def test_a_notebook_shows_a_picture_and_facts() -> None:
    shown = mw.repair(cube())._repr_html_()
    assert "data:image/png;base64," in shown and "closed" in shown and "volume 1" in shown
