from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any

from numpy.typing import NDArray

__version__: str

class Texture: ...

def run(
    arguments: Sequence[str],
    meshes: Sequence[dict[str, Any]],
    threads: int | None = None,
    hear: Callable[[str, float], object] | None = None,
) -> tuple[str | None, list[dict[str, Any]], str | None]: ...
def flags(verb: str) -> list[dict[str, Any]] | None: ...
def read(
    path: str | PathLike[str], in_format: str | None = None
) -> tuple[str | None, dict[str, Any], list[str]]: ...
def nearest(
    mesh: dict[str, Any], points: NDArray[Any], threads: int | None = None
) -> tuple[str | None, tuple[NDArray[Any], NDArray[Any], NDArray[Any]]]: ...
def write_grid(
    path: str | PathLike[str],
    values: NDArray[Any],
    lattice: tuple[Sequence[float], float, float | None],
    unit: str | None = None,
    format: str | None = None,
) -> str | None: ...
