"""The accessor of PyVista: ``mesh.meshwright.repair()``. PyVista finds it by itself where both are installed."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import pyvista

from . import verbs
from ._made import Grid, Mesh

__all__ = ["MeshwrightAccessor"]


def _method(name: str) -> Callable[..., Any]:
    function = getattr(verbs, name)

    @functools.wraps(function)
    def method(self: MeshwrightAccessor, *arguments: Any, **options: Any) -> Any:
        return _shown(function(self._mesh, *arguments, **options))

    return method


def _shown(made: Any) -> Any:
    if isinstance(made, (Mesh, Grid)):
        return made.to_pyvista()
    if isinstance(made, tuple):
        return tuple(_shown(one) for one in made)
    return made


@pyvista.register_dataset_accessor("meshwright", pyvista.DataSet)
class MeshwrightAccessor:
    """The functions of this module as methods of a dataset: what they return is a dataset again."""

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh

    repair = _method("repair")
    union = _method("union")
    intersection = _method("intersection")
    difference = _method("difference")
    dilate = _method("dilate")
    erode = _method("erode")
    open = _method("open")
    close = _method("close")
    canals = _method("canals")
    thicken = _method("thicken")
    hollow = _method("hollow")
    decimate = _method("decimate")
    sdf = _method("sdf")
    inspect = _method("inspect")
    compare = _method("compare")
    render = _method("render")
