"""What the tests share. They run on the meshes of `testdata/` and on made ones."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def in_the_project(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)


@pytest.fixture(scope="session")
def program() -> Path:
    """The command line program: the one that is named, or the one that was built last."""
    named = os.environ.get("MESHWRIGHT_PROGRAM")
    built = [ROOT / "target" / kind / "meshwright" for kind in ("debug", "release")]
    found = [Path(named)] if named else sorted((p for p in built if p.is_file()), key=lambda p: p.stat().st_mtime)
    if not found:
        pytest.skip("no program is built: cargo build, or MESHWRIGHT_PROGRAM=...")
    return found[-1]


@pytest.fixture
def run(program: Path):
    def run(*arguments: object) -> None:
        subprocess.run([program, *map(str, arguments), "-q"], check=True, cwd=ROOT)

    return run


def cube(side: float = 1.0, at: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    """A cube of twelve triangles, its lowest corner at `at`."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = np.array([t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])])
    return corners * side + np.array(at), faces


def quads() -> tuple[np.ndarray, np.ndarray]:
    """The same cube of six squares."""
    vertices, _ = cube()
    return vertices, np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
