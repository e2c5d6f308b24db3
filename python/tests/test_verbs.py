"""The functions do what the command line does, to the byte."""

from __future__ import annotations

import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, cube

import meshwright as mw

MUG, BALL, CUBE = "testdata/broken_mug.obj", "testdata/hollow_ball.stl", "testdata/two_cubes.3mf"


@pytest.mark.parametrize("extension", ["stl", "ply", "obj", "off", "3mf", "glb"])
@pytest.mark.parametrize("method", ["auto", "voxel"])
@pytest.mark.filterwarnings("ignore::meshwright.MeshwrightWarning")
def test_repair(tmp_path: Path, run, extension: str, method: str) -> None:
    run("repair", MUG, "-o", tmp_path / f"a.{extension}", "--resolution", 64, "--method", method)
    made = mw.repair(MUG, resolution=64, method=method, out_format=extension)
    made.write(tmp_path / f"b.{extension}")
    assert (tmp_path / f"a.{extension}").read_bytes() == (tmp_path / f"b.{extension}").read_bytes()
    # From memory it is the same.
    again = mw.repair(mw.read(MUG), resolution=64, method=method, out_format=extension)
    assert np.array_equal(again.vertices, made.vertices) and np.array_equal(again.faces, made.faces)


VERBS = {
    "union": ([MUG, BALL], {}),
    "intersection": ([BALL, BALL], {}),
    "difference": ([MUG, BALL], {}),
    "dilate": ([BALL], {"radius": "2%"}),
    "erode": ([BALL], {"radius": "1%"}),
    "open": ([BALL], {"radius": "2%"}),
    "close": ([BALL], {"radius": "4%"}),
    "thicken": ([BALL], {"min": "25%"}),
    "hollow": ([MUG], {"wall": "6%"}),
    "decimate": ([BALL], {"ratio": 0.5}),
}


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.filterwarnings("ignore::meshwright.MeshwrightWarning")
def test_verbs(tmp_path: Path, program: Path, verb: str) -> None:
    inputs, options = VERBS[verb]
    if verb != "decimate":
        options = {**options, "resolution": 32}
    flags = [f"--{name}={value}" for name, value in options.items()]
    told = subprocess.run(
        [program, verb, *inputs, "-o", tmp_path / "a.ply", "-q", *flags], cwd=ROOT, capture_output=True, text=True
    )
    if told.returncode not in (0, 3):
        with pytest.raises(mw.Error) as error:
            getattr(mw, verb)(*inputs, **options)
        assert error.value.message.split(":")[0].split(" ")[0] in told.stderr
        return
    made = getattr(mw, verb)(*inputs, **options)
    made.write(tmp_path / "b.ply")
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()


@pytest.mark.filterwarnings("ignore::meshwright.MeshwrightWarning")
def test_csg_and_field(tmp_path: Path, run) -> None:
    run("csg", "a - b", f"a={MUG}", f"b={BALL}", "-o", tmp_path / "a.ply", "--resolution", 32)
    mw.csg("a - b", {"a": mw.read(MUG), "b": BALL}, resolution=32).write(tmp_path / "b.ply")
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
    run("field", "offset(a, 3%)", f"a={BALL}", "-o", tmp_path / "c.ply", "--resolution", 32)
    mw.field("offset(a, 3%)", {"a": BALL}, resolution=32).write(tmp_path / "d.ply")
    assert (tmp_path / "c.ply").read_bytes() == (tmp_path / "d.ply").read_bytes()
    run("field", "offset(a, 3%)", f"a={BALL}", "-o", tmp_path / "c.npy", "--resolution", 32)
    grid = mw.field("offset(a, 3%)", {"a": BALL}, resolution=32, grid=True)
    assert np.array_equal(np.load(tmp_path / "c.npy"), grid.values)
    frames = mw.field("morph(a, b, t)", {"a": BALL, "b": MUG}, resolution=32, frames=3)
    assert len(frames) == 3 and all(isinstance(frame, mw.Mesh) for frame in frames)


def test_reports_are_those_of_the_command_line(program: Path) -> None:
    import json

    told = subprocess.run([program, "inspect", MUG, "--json"], cwd=ROOT, capture_output=True, text=True, check=True)
    expected = json.loads(told.stdout)
    with pytest.warns(mw.MeshwrightWarning):
        report = mw.inspect(MUG)
    # What to type is told where something is typed.
    for entry in expected["result"]["next"]:
        assert entry.pop("command").startswith("meshwright repair ")
    for name in ("verb", "exit", "inputs", "result", "warnings"):
        assert report[name] == expected[name]
    found = mw.compare(cube(), cube(2.0))
    assert found["a"]["volume"] == 1 and found["b"]["volume"] == 8


def test_render(tmp_path: Path, run) -> None:
    run("render", BALL, "-o", tmp_path / "a.png", "--width", 80, "--height", 60)
    pixels = mw.render(BALL, width=80, height=60)
    assert pixels.shape == (60, 80, 4) and pixels.dtype == np.uint8
    from meshwright._made import _png

    # Two encoders, the same pixels.
    pil = pytest.importorskip("PIL.Image")
    (tmp_path / "b.png").write_bytes(_png(pixels))
    a, b = (np.asarray(pil.open(tmp_path / name).convert("RGBA")) for name in ("a.png", "b.png"))
    assert np.array_equal(a, b) and np.array_equal(a, pixels)


def test_open_holes_stay_open_when_asked() -> None:
    vertices, faces = cube()
    with pytest.warns(mw.LimitWarning):
        made = mw.repair((vertices, faces[2:]), fill="none")
    assert len(made.faces) == 10 and made.validity["open_edges"] == 4


def test_unit_and_colours_travel(tmp_path: Path) -> None:
    vertices, faces = cube()
    rgba = np.random.default_rng(1).integers(0, 255, (12, 4)).astype(np.uint8)
    rgba[:, 3] = 255
    mesh = mw.Mesh(vertices, faces, unit="mm", colours=mw.Colours("face", rgba))
    made = mw.repair(mesh)
    assert made.unit == "mm" and made.colours is not None and made.colours.of == "face"
    assert np.array_equal(made.colours.rgba, rgba)
    made.write(tmp_path / "cube.3mf")
    back = mw.read(tmp_path / "cube.3mf")
    assert back.unit == "mm" and back.colours is not None
    assert np.array_equal(back.colours.rgba, rgba)


def test_threads_give_the_same_and_do_not_disturb_each_other() -> None:
    mesh = mw.read(BALL)
    alone = mw.repair(mesh, resolution=12, method="voxel", rebuild=True, threads=1)

    def one(number: int) -> bool:
        made = mw.repair(mesh, resolution=12, method="voxel", rebuild=True, threads=None if number % 2 else 1)
        return np.array_equal(made.vertices, alone.vertices) and np.array_equal(made.faces, alone.faces)

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(one, range(200)))


def test_other_threads_run_meanwhile() -> None:
    count, over = 0, threading.Event()

    def work() -> None:
        mw.dilate(BALL, radius="2%", resolution=128)
        over.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not over.wait(0.001):
        count += 1
    thread.join()
    assert count > 20


def test_two_processes_of_multiprocessing() -> None:
    code = (
        "import multiprocessing as mp, meshwright as mw\n"
        "def f(n): return len(mw.repair('testdata/broken_mug.obj', resolution=24).faces)\n"
        "if __name__ == '__main__':\n"
        "    mw.repair('testdata/broken_mug.obj', resolution=24)\n"
        "    with mp.get_context('spawn').Pool(2) as pool: print(len(set(pool.map(f, range(6)))))\n"
    )
    path = ROOT / "target" / "two_processes.py"
    path.parent.mkdir(exist_ok=True)
    path.write_text(code)
    told = subprocess.run([sys.executable, "-W", "ignore", path], capture_output=True, text=True, cwd=ROOT, timeout=120)
    assert told.stdout.strip() == "1", told.stderr


def test_the_functions_are_those_of_the_program() -> None:
    told = subprocess.run([sys.executable, "tools/python_verbs.py", "--check"], cwd=ROOT, capture_output=True, text=True)
    assert told.returncode == 0, told.stderr
