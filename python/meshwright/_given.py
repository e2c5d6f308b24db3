"""What counts as a mesh, and how its arrays are found. Nothing is copied here that has a type the library takes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Protocol, TypeAlias, Union, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import BadArray, UsageError

__all__ = ["Length", "MeshLike", "WithFaces", "as_given", "as_points"]


@runtime_checkable
class WithFaces(Protocol):
    """Anything with ``vertices``, shape (n, 3), and ``faces``, shape (m, 3): :class:`meshwright.Mesh`, ``trimesh.Trimesh`` and many others."""

    @property
    def vertices(self) -> Any: ...

    @property
    def faces(self) -> Any: ...


#: A length: a number in model units, or text such as ``"0.4mm"``, ``"1%"`` (of the diagonal of the bounding box) or ``"2h"`` (voxels).
Length: TypeAlias = Union[str, float]

#: A mesh: a path, an object with ``vertices`` and ``faces``, a PyVista, Open3D or meshio mesh, or a pair of arrays.
MeshLike: TypeAlias = Union[str, "os.PathLike[str]", WithFaces, tuple[ArrayLike, ArrayLike], Any]

_INTEGERS = (np.dtype(np.uint32), np.dtype(np.int32), np.dtype(np.int64), np.dtype(np.uint64))
_UNITS = {"um", "mm", "cm", "in", "ft", "m"}


def as_given(mesh: MeshLike, name: str) -> str | dict[str, Any]:
    """A path as the command line takes it, or the arrays of a mesh under ``name``."""
    if isinstance(mesh, (str, os.PathLike)):
        path = os.fspath(mesh)
        return os.path.join(".", path) if path.startswith(("-", "<")) else path
    vertices, faces = _arrays(mesh)
    return {
        "name": name,
        "vertices": _vertices(vertices, name),
        "faces": _faces(faces, name),
        "colours": _colours(mesh),
        "texture": getattr(mesh, "_texture", None),
        "unit": _unit(mesh),
    }


def as_points(points: ArrayLike) -> NDArray[Any]:
    """Points as rows of three numbers."""
    array = np.asarray(points)
    if array.ndim == 1 and array.shape == (3,):
        array = array.reshape(1, 3)
    return _vertices(array, "the points")


def _arrays(mesh: Any) -> tuple[Any, Any]:
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        return mesh[0], mesh[1]
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return mesh.vertices, mesh.faces
    if hasattr(mesh, "vertices") and hasattr(mesh, "triangles"):  # Open3D
        return np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    if hasattr(mesh, "to_mesh"):  # a scene of trimesh
        return _arrays(mesh.to_mesh())
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict") and not hasattr(mesh, "extract_surface"):  # meshio
        triangles = mesh.cells_dict.get("triangle")
        if triangles is None:
            raise UsageError("the mesh has no cells of the kind `triangle`")
        return mesh.points, triangles
    if hasattr(mesh, "points") and hasattr(mesh, "n_cells"):  # PyVista
        surface = mesh if hasattr(mesh, "faces") else mesh.extract_surface(algorithm="dataset_surface")
        if getattr(surface, "n_strips", 0):
            surface = surface.triangulate()
        faces = np.asarray(surface.faces)
        if len(faces) % 4 == 0 and bool(np.all(faces[::4] == 3)):
            return surface.points, faces.reshape(-1, 4)[:, 1:]
        return surface.points, faces
    raise UsageError(
        f"{type(mesh).__name__} is no mesh",
        "a path, an object with `vertices` and `faces`, or a pair of arrays (vertices, faces)",
    )


def _vertices(vertices: Any, name: str) -> NDArray[Any]:
    array = np.asarray(vertices)
    if array.ndim != 2 or array.shape[1] != 3:
        raise BadArray(f"{name}: rows of three numbers are needed, and this is an array of shape {array.shape}")
    if array.dtype not in (np.float32, np.float64):
        if array.dtype.kind not in "fiub":
            raise BadArray(f"{name}: numbers are needed, and these are {array.dtype}")
        array = array.astype(np.float64)
    return array


def _faces(faces: Any, name: str) -> NDArray[Any]:
    array = np.asarray(faces)
    if array.size == 0 and array.dtype.kind == "f":
        array = array.astype(np.int64)
    if array.dtype.kind not in "iu":
        raise BadArray(f"{name}: numbers of vertices are needed, and these are {array.dtype}")
    if array.ndim == 1:
        return array.astype(np.int64, copy=False)
    if array.ndim != 2:
        raise BadArray(f"{name}: faces are rows of numbers, and this is an array of shape {array.shape}")
    if array.shape[1] == 3:
        return array if array.dtype in _INTEGERS else array.astype(np.int64)
    corners = np.full((len(array), 1), array.shape[1], dtype=np.int64)
    return np.hstack([corners, array.astype(np.int64)]).ravel()


def _colours(mesh: Any) -> tuple[str, NDArray[np.uint8]] | None:
    own = getattr(mesh, "colours", None)
    if own is not None and hasattr(own, "of") and hasattr(own, "rgba"):
        return own.of, own.rgba
    visual: Any = getattr(mesh, "visual", None)
    kind = getattr(visual, "kind", None) if getattr(visual, "defined", False) else None
    if kind not in ("vertex", "face"):
        return None
    rgba = np.asarray(visual.vertex_colors if kind == "vertex" else visual.face_colors, dtype=np.uint8)
    return (kind, rgba) if rgba.ndim == 2 and rgba.shape[1] == 4 else None


def _unit(mesh: Any) -> str | None:
    unit = getattr(mesh, "unit", None) or getattr(mesh, "units", None)
    if not isinstance(unit, str):
        return None
    words = {
        "millimeter": "mm",
        "centimeter": "cm",
        "meter": "m",
        "inch": "in",
        "inche": "in",
        "foot": "ft",
        "feet": "ft",
        "micron": "um",
    }
    word = unit.lower()
    word = words.get(word.removesuffix("s"), words.get(word, word))
    return word if word in _UNITS else None


def several(meshes: Sequence[MeshLike]) -> Sequence[MeshLike]:
    """Meshes given one by one, or as one list."""
    if len(meshes) == 1 and isinstance(meshes[0], (list, tuple)) and not _is_pair(meshes[0]):
        return list(meshes[0])
    return meshes


def _is_pair(value: Sequence[Any]) -> bool:
    return len(value) == 2 and all(isinstance(one, (np.ndarray, list)) and np.ndim(one) >= 1 for one in value)
