"""The Python of the documents, run as it stands there, with meshes of `testdata/` in the place of those that it names."""

from __future__ import annotations

import re
from pathlib import Path

import meshwright as mw
import pytest

from conftest import ROOT

FILES = {"scan.stl": "torus.ply", "handle.obj": "overlapping_boxes.obj", "hole.stl": "hollow_ball.stl"}


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_the_python_of_the_documents_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), flags=re.S | re.M)
    assert blocks, f"{page} has no Python"
    for name, source in FILES.items():
        mw.read(ROOT / "testdata" / source).write(tmp_path / name)
    monkeypatch.chdir(tmp_path)
    known: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, page, "exec"), known)
    assert (tmp_path / "part.3mf").stat().st_size > 0
