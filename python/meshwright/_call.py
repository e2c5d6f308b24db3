"""From a function's arguments to a verb, and from what it made to objects."""

from __future__ import annotations

import json
import os
import sys
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias, Union

from . import _native
from ._given import MeshLike, as_given
from ._made import Grid, Mesh
from .errors import LimitWarning, MeshwrightWarning, failure, in_python

__all__ = ["Progress", "call"]

#: ``True`` for a bar, or a function that is told the stage and the share of it that is done, 0 to 1.
Progress: TypeAlias = Union[bool, Callable[[str, float], object]]


def call(
    verb: str,
    meshes: Sequence[MeshLike] | Mapping[str, MeshLike],
    options: Mapping[str, Any],
    *,
    expression: str | None = None,
    result: str | None,
    threads: int | None = None,
    progress: Progress = False,
) -> tuple[list[Any], dict[str, Any]]:
    """Runs a verb: what it has made, and its report. ``meshes`` by name for an expression. ``result``: the format whose numbers the result has; ``None``
    where there is only a report."""
    arguments = [verb] if expression is None else [verb, expression]
    arrays = []
    for name, label, mesh in _named(meshes):
        given = as_given(mesh, label)
        if isinstance(given, dict):
            arrays.append(given)
            given = label
        arguments.append(given if name is None else f"{name}={given}")
    if result is not None:
        arguments += ["-o", f"<result>.{result}"]
    arguments += flags(options)
    with _following(progress, verb) as hear:
        failed, products, report = _native.run(arguments, arrays, threads, hear)
    told = json.loads(report) if report else {}
    _warn(told)
    if failed is not None:
        raise failure(failed, report)
    return [_product(product, told) for product in products], told


def _named(meshes: Sequence[MeshLike] | Mapping[str, MeshLike]) -> list[tuple[str | None, str, MeshLike]]:
    """The name of each mesh in the expression, if it has one, and what messages call it."""
    if isinstance(meshes, Mapping):
        return [(name, f"`{name}`", mesh) for name, mesh in meshes.items()]
    if len(meshes) == 1:
        return [(None, "the mesh", meshes[0])]
    return [(None, f"mesh {number}", mesh) for number, mesh in enumerate(meshes, 1)]


def flags(options: Mapping[str, Any]) -> list[str]:
    """Keywords as the flags of the command line."""
    arguments = []
    for name, value in options.items():
        flag = "--" + name.rstrip("_").replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            arguments.append(flag)
        elif isinstance(value, (list, tuple)) and value and isinstance(value[0], (list, tuple, str)):
            # Each by itself: a flag that may be given several times.
            arguments += [f"{flag}={_text(one)}" for one in value]
        else:
            arguments.append(f"{flag}={_text(value)}")
    return arguments


def _text(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return ",".join(_text(one) for one in value)
    if isinstance(value, os.PathLike):
        return str(os.fspath(value))
    return str(value)


def _product(product: dict[str, Any], report: dict[str, Any]) -> Any:
    match product.pop("kind"):
        case "mesh":
            return Mesh._of(product, report)
        case "grid":
            # As the library has them x runs fastest; the first index is that of x.
            return Grid(product.pop("values").T, report=report, **product)
        case _:
            return product["pixels"]


def _warn(report: dict[str, Any]) -> None:
    kind = LimitWarning if report.get("exit") == 3 and "error" not in report else MeshwrightWarning
    level, frame = 2, sys._getframe(1)
    # The first frame outside of this package is the caller's.
    while frame.f_back is not None and frame.f_globals.get("__name__", "").split(".")[0] == "meshwright":
        frame, level = frame.f_back, level + 1
    for sentence in report.get("warnings", []):
        warnings.warn(in_python(sentence), kind, stacklevel=level)


class _following:
    """Follows a run with a bar, or with the caller's function."""

    def __init__(self, progress: Progress, verb: str) -> None:
        self.hear: Callable[[str, float], object] | None = None
        self.bar: Any = None
        if callable(progress):
            self.hear = progress
        elif progress:
            try:
                from tqdm.auto import tqdm  # type: ignore[import-untyped,unused-ignore]
            except ImportError:
                return
            self.bar = tqdm(total=1.0, desc=verb, bar_format="{desc:<24} {percentage:3.0f}%|{bar}| {elapsed}")
            self.hear = self._move

    def _move(self, stage: str, share: float) -> None:
        self.bar.set_description(stage, refresh=False)
        self.bar.n = share
        self.bar.refresh()

    def __enter__(self) -> Callable[[str, float], object] | None:
        return self.hear

    def __exit__(self, *_: object) -> None:
        if self.bar is not None:
            self.bar.close()
