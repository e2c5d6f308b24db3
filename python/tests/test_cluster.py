"""The scripts of `examples/cluster`, on this machine: the same files as the command line, also when a worker is killed."""

from __future__ import annotations

import hashlib
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

import meshwright as mw

SCRIPTS = ROOT / "examples" / "cluster"


def hashes(folder: Path) -> dict[str, str]:
    files = [p for p in folder.rglob("*") if p.suffix in (".obj", ".stl", ".ply")]
    return {str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Six meshes in two folders, and one that is none."""
    for number in range(3):
        place = tmp_path / "in" / f"part{number}"
        place.mkdir(parents=True)
        shutil.copy(ROOT / "testdata" / "broken_mug.obj", place / "mug.obj")
        shutil.copy(ROOT / "testdata" / "hollow_ball.stl", place / "ball.stl")
    (tmp_path / "in" / "part0" / "garbage.stl").write_text("solid nothing of the sort\n")
    return tmp_path / "in"


def workers_of(parent: int) -> list[int]:
    """Processes below one that hold much memory: the workers, not their helpers."""
    found, below = [], {parent}
    for stat in sorted(Path("/proc").glob("[0-9]*"), key=lambda p: int(p.name)):
        try:
            fields = (stat / "stat").read_text().rsplit(")", 1)[1].split()
            memory = int((stat / "statm").read_text().split()[1])
        except (OSError, IndexError):
            continue
        if int(fields[1]) in below:
            below.add(int(stat.name))
            if memory * 4096 > 60 << 20:
                found.append(int(stat.name))
    return found


def test_dask_repairs_a_folder_also_without_a_worker(tmp_path: Path, folder: Path, run) -> None:
    pytest.importorskip("distributed")
    parquet = pytest.importorskip("pyarrow.parquet")
    command = [sys.executable, SCRIPTS / "dask_batch.py", folder, tmp_path / "out", "--resolution", "40"]
    process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, text=True, cwd=tmp_path)
    assert process.stdout is not None
    lines = [process.stdout.readline()]
    # One has been done: a worker is killed in the middle of the others.
    killed = workers_of(process.pid)[-1:]
    for worker in killed:
        os.kill(worker, signal.SIGKILL)
    lines += process.stdout.readlines()
    assert process.wait(120) == 0 and killed
    table = parquet.read_table(tmp_path / "out" / "reports.parquet").to_pylist()
    assert sorted(row["class"] for row in table) == ["InputError"] + 6 * ["done"], table
    for path in ("part0/mug.obj", "part1/ball.stl"):
        run("repair", folder / path, "-o", tmp_path / Path(path).name, "--resolution", 40)
        expected = hashlib.sha256((tmp_path / Path(path).name).read_bytes()).hexdigest()
        assert hashes(tmp_path / "out")[path] == expected
    done = [row for row in table if row["class"] == "done"]
    told = {Path(row["output"]).relative_to(tmp_path / "out").as_posix(): row["sha256"] for row in done}
    assert told == hashes(tmp_path / "out")


def test_dask_makes_a_distance_in_slabs(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    zarr = pytest.importorskip("zarr", minversion="3")
    mesh = ROOT / "testdata" / "broken_mug.obj"
    command = [sys.executable, SCRIPTS / "dask_sdf.py", mesh, tmp_path / "mug.zarr", "--resolution", "48", "--planes", "16"]
    subprocess.run([str(word) for word in command], check=True, cwd=tmp_path, timeout=300)
    whole, array = mw.sdf(mesh, resolution=48, band="4h"), zarr.open_array(tmp_path / "mug.zarr", mode="r")
    assert np.array_equal(array[:].view(np.uint32), whole.values.view(np.uint32))
    assert tuple(array.attrs["origin"]) == whole.origin and array.attrs["spacing"] == whole.spacing


def test_ray_repairs_a_folder(tmp_path: Path, folder: Path) -> None:
    pytest.importorskip("ray")
    command = [sys.executable, SCRIPTS / "ray_batch.py", folder, tmp_path / "out", "--resolution", "24"]
    subprocess.run([str(word) for word in command], check=True, cwd=tmp_path, timeout=300)
    assert len(hashes(tmp_path / "out")) == 6
    assert len((tmp_path / "out" / "reports.jsonl").read_text().splitlines()) == 7
