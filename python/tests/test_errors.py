"""Each kind of failure has its class, its fields, and words that say what to try in the terms of Python."""

from __future__ import annotations

import pickle
from pathlib import Path
import threading
import time

import numpy as np
import pytest
from conftest import cube

import meshwright as mw


def failing(kind: type[mw.Error], call, *arguments, **options) -> mw.Error:
    with pytest.raises(kind) as raised:
        call(*arguments, **options)
    error = raised.value
    assert type(error) is kind and error.message and "--" not in str(error)
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is kind and str(again) == str(error) and vars(again) == vars(error)
    return error


def test_usage() -> None:
    assert "0" in failing(mw.UsageError, mw.repair, cube(), resolution=0).message
    failing(mw.UsageError, mw.repair, cube(), resolution=8, voxel=1)
    failing(mw.UsageError, mw.union, cube())
    failing(mw.UsageError, mw.csg, "a +", {"a": cube()})
    with pytest.raises(TypeError, match="resolutoin"):
        mw.repair(cube(), resolutoin=64)  # type: ignore[call-arg]


def test_a_wheel_without_graphics_says_what_it_lacks() -> None:
    try:
        mw.repair(cube(), backend="gpu")
    except mw.DeviceError:
        pytest.skip("this one has the feature `gpu`")
    except mw.UsageError:
        assert "feature `gpu`" in failing(mw.UsageError, mw.repair, cube(), backend="gpu").message
    else:
        pytest.skip("this one has the feature `gpu`")


def test_input(tmp_path) -> None:
    failing(mw.InputError, mw.repair, tmp_path / "nothing.stl")
    (tmp_path / "bad.stl").write_bytes(b"solid nothing of the sort")
    failing(mw.InputError, mw.read, tmp_path / "bad.stl")
    failing(mw.UsageError, mw.read, "testdata/broken_mug.obj", in_format="doc")


def test_empty_and_nothing_enclosed() -> None:
    line = ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]])
    assert failing(mw.Empty, mw.repair, line).operand == 0
    assert failing(mw.Empty, mw.union, cube(), line).operand == 1
    one = ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    assert failing(mw.NothingEnclosed, mw.repair, one).reason in ("scattered", "open-sheet")
    assert failing(mw.NothingEnclosed, mw.intersection, cube(), cube(at=(5, 0, 0))).reason == "no-common-part"
    error = failing(mw.NothingEnclosed, mw.repair, cube(), drop_smaller=2)
    assert (error.reason, error.largest, error.least, error.surfaces) == ("all-smaller", 1.0, 2.0, 1)
    assert failing(mw.NothingLeft, mw.erode, cube(), radius=0.6, resolution=32).thinner_than == 1.2


def test_not_exact_and_not_closed() -> None:
    vertices, faces = cube()
    error = failing(mw.NotExact, mw.repair, (vertices, faces[1:]), method="exact")
    assert (error.edges, error.operand, np.shape(error.ends)) == (3, 0, (2, 3))
    assert failing(mw.NotClosed, mw.sdf, (vertices, faces[1:]), method="prism", resolution=16).problem


def test_withheld_and_limits() -> None:
    assert "as fail_on asks" in failing(mw.LimitError, mw.inspect, (cube()[0], cube()[1][1:]), fail_on="open").message
    assert failing(mw.LimitError, mw.compare, cube(), cube(2.0), fail_on_max=0.1).report["result"]
    error = failing(mw.MemoryLimit, mw.dilate, cube(), radius="10%", resolution=1000, max_memory="100M")
    assert error.needed > error.allowed == 100_000_000 and isinstance(error, MemoryError)


def test_voxel_and_deadline() -> None:
    failing(mw.VoxelError, mw.dilate, cube(), radius=0.1, voxel=1e-9)
    error = failing(mw.Deadline, mw.dilate, "testdata/hollow_ball.stl", radius="2%", resolution=512, timeout=0.2)
    assert isinstance(error, TimeoutError)


def test_write(tmp_path) -> None:
    failing(mw.UsageError, mw.write, cube(), tmp_path / "a.doc")
    failing(mw.UsageError, mw.write, cube(), tmp_path / "no" / "folder" / "a.stl")
    if Path("/dev/full").exists():
        failing(mw.WriteFailed, mw.write, cube(), "/dev/full", out_format="stl")


def test_every_class_is_known_to_the_program() -> None:
    """The words of the program and the classes of the module are the same ones."""
    from meshwright.errors import _CLASSES

    text = open("src/cli/class.rs").read().split("pub enum Class {")[1].split("\n}")[0]
    names = [line.strip().rstrip(",") for line in text.splitlines() if line.strip() and "//" not in line]
    words = {"".join(f"-{c.lower()}" if c.isupper() else c for c in name).lstrip("-") for name in names}
    assert words - {"interrupted"} == set(_CLASSES) - {"bad-array"}


def test_an_interrupt_ends_a_call_within_a_second() -> None:
    import _thread
    import signal

    # A shell lets what it runs in the background ignore it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for verb in ("dilate", "repair"):
        options = {"radius": "2%"} if verb == "dilate" else {"rebuild": True}
        threading.Timer(0.5, _thread.interrupt_main).start()
        start = time.perf_counter()
        with pytest.raises(KeyboardInterrupt):
            getattr(mw, verb)("testdata/hollow_ball.stl", resolution=400, **options)
        assert time.perf_counter() - start < 1.5


def test_progress_is_told_and_may_stop_the_work() -> None:
    told: list[tuple[str, float]] = []
    mw.repair("testdata/broken_mug.obj", resolution=64, method="voxel", progress=lambda stage, share: told.append((stage, share)))
    assert told and all(isinstance(stage, str) and 0 <= share <= 1 for stage, share in told)

    def enough(stage: str, share: float) -> None:
        raise RuntimeError("enough")

    start = time.perf_counter()
    with pytest.raises(RuntimeError, match="enough"):
        mw.dilate("testdata/hollow_ball.stl", radius="2%", resolution=400, progress=enough)
    assert time.perf_counter() - start < 1.5


def test_a_bar(capsys) -> None:
    pytest.importorskip("tqdm")
    mw.repair("testdata/broken_mug.obj", resolution=64, method="voxel", progress=True)
    assert "%|" in capsys.readouterr().err
