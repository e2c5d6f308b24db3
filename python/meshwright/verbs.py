"""One function for each verb of the command line. This file is made by `tools/python_verbs.py`; do not edit it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import NDArray

from ._call import Progress, call
from ._given import Length, MeshLike, several
from ._made import Grid, Mesh

__all__ = [
    "canals",
    "close",
    "compare",
    "csg",
    "decimate",
    "difference",
    "dilate",
    "erode",
    "field",
    "hollow",
    "inspect",
    "intersection",
    "open",
    "render",
    "repair",
    "sdf",
    "thicken",
    "union",
]


def repair(
    mesh: MeshLike,
    *,
    outer: bool | Length | None = None,
    thickness: Length | None = None,
    part: str | Sequence[str] | None = None,
    max_hole: Length | None = None,
    holes: int | Sequence[int] | None = None,
    preset: Literal["print", "scan", "cad"] | None = None,
    method: Literal["auto", "exact", "voxel"] | None = None,
    resolution: int | None = None,
    voxel: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    tolerance: Length | None = None,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    vote: Literal["winding", "half-rays", "majority", "paper"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    rebuild: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    map: str | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    keep_partial: bool = False,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh:
    """Makes one closed, oriented solid surface of a broken mesh. What is right in it stays exactly as it is; ``.sources`` and ``.kinds`` of the result
    say for each triangle where it comes from.

    Keywords, as on the command line:

    - ``outer``: Keep the surface as a ball of this diameter sees it from outside: what is narrower is no way in, and what the ball does not come to
      goes [default of LEN: 1%].
    - ``thickness``: How thick sheets become that the ball of outer sees from both sides.
    - ``part``: Work on this object alone, by its name or the number that ``inspect`` lists (may be given several times): with each the others stay as
      they are, without it they are left out.
    - ``max_hole``: Leave holes open whose rim is wider than this (exit status 3 where there are some).
    - ``holes``: Close these holes alone, by the numbers that ``inspect holes`` lists (exit status 3 where others are left open).
    - ``preset``: Options that suit printing, scans or parts; those given by hand win.
    - ``method``: How the result is made where surfaces touch or cross (default: auto).
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``orient``: Which side of the triangles is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap (default: positive).
    - ``tolerance``: How far vertices at cracks may move so that these close before anything is called a hole, or ``off`` [default: 0.001%].
    - ``fill``: How holes are closed that a lid over their rim alone closes; others are closed from voxels (default: auto).
    - ``vote``: How rays that disagree are settled (default: winding).
    - ``backend``: Which processor finds the rays' crossings; the result is the same (default: auto).
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``rebuild``: Build the whole surface anew from the voxels, also where the input is right as it is.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``map``: Write the result to this file, coloured by what is kept, cut, rebuilt and made up.
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``keep_partial``: Write the result also when most of the shape is lost (exit status 3); force does so, too.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> mug = mw.repair("testdata/broken_mug.obj", resolution=64)
    >>> mug.validity["open_edges"]
    0
    """
    options: dict[str, Any] = {"outer": outer, "thickness": thickness, "part": part, "max_hole": max_hole, "holes": holes, "preset": preset, "method": method, "resolution": resolution, "voxel": voxel, "orient": orient, "inside": inside, "tolerance": tolerance, "fill": fill, "vote": vote, "backend": backend, "no_collapse": no_collapse, "no_fit": no_fit, "rebuild": rebuild, "simplify": simplify, "drop_smaller": drop_smaller, "map": map, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "keep_partial": keep_partial, "timeout": timeout}
    made, _ = call("repair", [mesh], options, result=str(out_format or "ply"), threads=threads, progress=progress)
    return cast(Mesh, made[0])


def union(
    *meshes: MeshLike | Sequence[MeshLike],
    preset: Literal["print", "scan", "cad"] | None = None,
    method: Literal["auto", "exact", "voxel"] | None = None,
    resolution: int | None = None,
    voxel: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    tolerance: Length | None = None,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    vote: Literal["winding", "half-rays", "majority", "paper"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    rebuild: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    map: str | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    keep_partial: bool = False,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh:
    """Everything inside at least one of the meshes, each of which may be broken. Meshes are given one by one, or as one list.

    Keywords, as on the command line:

    - ``preset``: Options that suit printing, scans or parts; those given by hand win.
    - ``method``: How the result is made where surfaces touch or cross (default: auto).
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``orient``: Which side of the triangles is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap (default: positive).
    - ``tolerance``: How far vertices at cracks may move so that these close before anything is called a hole, or ``off`` [default: 0.001%].
    - ``fill``: How holes are closed that a lid over their rim alone closes; others are closed from voxels (default: auto).
    - ``vote``: How rays that disagree are settled (default: winding).
    - ``backend``: Which processor finds the rays' crossings; the result is the same (default: auto).
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``rebuild``: Build the whole surface anew from the voxels, also where the input is right as it is.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``map``: Write the result to this file, coloured by what is kept, cut, rebuilt and made up.
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``keep_partial``: Write the result also when most of the shape is lost (exit status 3); force does so, too.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> mug = mw.read("testdata/broken_mug.obj")
    >>> both = mw.union(mug, "testdata/hollow_ball.stl", resolution=64)
    >>> sorted(set(both.sources[:, 0].tolist()) - {-1})
    [0, 1]
    """
    options: dict[str, Any] = {"preset": preset, "method": method, "resolution": resolution, "voxel": voxel, "orient": orient, "inside": inside, "tolerance": tolerance, "fill": fill, "vote": vote, "backend": backend, "no_collapse": no_collapse, "no_fit": no_fit, "rebuild": rebuild, "simplify": simplify, "drop_smaller": drop_smaller, "map": map, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "keep_partial": keep_partial, "timeout": timeout}
    made, _ = call("union", several(meshes), options, result=str(out_format or "ply"), threads=threads, progress=progress)
    return cast(Mesh, made[0])


def intersection(
    *meshes: MeshLike | Sequence[MeshLike],
    preset: Literal["print", "scan", "cad"] | None = None,
    method: Literal["auto", "exact", "voxel"] | None = None,
    resolution: int | None = None,
    voxel: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    tolerance: Length | None = None,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    vote: Literal["winding", "half-rays", "majority", "paper"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    rebuild: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    map: str | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    keep_partial: bool = False,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh:
    """Everything inside all of the meshes, each of which may be broken.

    Keywords, as on the command line:

    - ``preset``: Options that suit printing, scans or parts; those given by hand win.
    - ``method``: How the result is made where surfaces touch or cross (default: auto).
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``orient``: Which side of the triangles is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap (default: positive).
    - ``tolerance``: How far vertices at cracks may move so that these close before anything is called a hole, or ``off`` [default: 0.001%].
    - ``fill``: How holes are closed that a lid over their rim alone closes; others are closed from voxels (default: auto).
    - ``vote``: How rays that disagree are settled (default: winding).
    - ``backend``: Which processor finds the rays' crossings; the result is the same (default: auto).
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``rebuild``: Build the whole surface anew from the voxels, also where the input is right as it is.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``map``: Write the result to this file, coloured by what is kept, cut, rebuilt and made up.
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``keep_partial``: Write the result also when most of the shape is lost (exit status 3); force does so, too.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> mw.intersection("testdata/hollow_ball.stl", "testdata/hollow_ball.stl", resolution=64).validity["open_edges"]
    0
    """
    options: dict[str, Any] = {"preset": preset, "method": method, "resolution": resolution, "voxel": voxel, "orient": orient, "inside": inside, "tolerance": tolerance, "fill": fill, "vote": vote, "backend": backend, "no_collapse": no_collapse, "no_fit": no_fit, "rebuild": rebuild, "simplify": simplify, "drop_smaller": drop_smaller, "map": map, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "keep_partial": keep_partial, "timeout": timeout}
    made, _ = call("intersection", several(meshes), options, result=str(out_format or "ply"), threads=threads, progress=progress)
    return cast(Mesh, made[0])


def difference(
    *meshes: MeshLike | Sequence[MeshLike],
    preset: Literal["print", "scan", "cad"] | None = None,
    method: Literal["auto", "exact", "voxel"] | None = None,
    resolution: int | None = None,
    voxel: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    tolerance: Length | None = None,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    vote: Literal["winding", "half-rays", "majority", "paper"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    rebuild: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    map: str | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    keep_partial: bool = False,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh:
    """The first mesh without all the others; each may be broken.

    Keywords, as on the command line:

    - ``preset``: Options that suit printing, scans or parts; those given by hand win.
    - ``method``: How the result is made where surfaces touch or cross (default: auto).
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``orient``: Which side of the triangles is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap (default: positive).
    - ``tolerance``: How far vertices at cracks may move so that these close before anything is called a hole, or ``off`` [default: 0.001%].
    - ``fill``: How holes are closed that a lid over their rim alone closes; others are closed from voxels (default: auto).
    - ``vote``: How rays that disagree are settled (default: winding).
    - ``backend``: Which processor finds the rays' crossings; the result is the same (default: auto).
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``rebuild``: Build the whole surface anew from the voxels, also where the input is right as it is.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``map``: Write the result to this file, coloured by what is kept, cut, rebuilt and made up.
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``keep_partial``: Write the result also when most of the shape is lost (exit status 3); force does so, too.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> try:
    ...     mw.difference("testdata/hollow_ball.stl", "testdata/hollow_ball.stl", resolution=64)
    ... except mw.NothingEnclosed as error:
    ...     print(error.reason)
    no-common-part
    """
    options: dict[str, Any] = {"preset": preset, "method": method, "resolution": resolution, "voxel": voxel, "orient": orient, "inside": inside, "tolerance": tolerance, "fill": fill, "vote": vote, "backend": backend, "no_collapse": no_collapse, "no_fit": no_fit, "rebuild": rebuild, "simplify": simplify, "drop_smaller": drop_smaller, "map": map, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "keep_partial": keep_partial, "timeout": timeout}
    made, _ = call("difference", several(meshes), options, result=str(out_format or "ply"), threads=threads, progress=progress)
    return cast(Mesh, made[0])


def csg(
    expression: str,
    meshes: Mapping[str,
    MeshLike],
    *,
    preset: Literal["print", "scan", "cad"] | None = None,
    method: Literal["auto", "exact", "voxel"] | None = None,
    resolution: int | None = None,
    voxel: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    tolerance: Length | None = None,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    vote: Literal["winding", "half-rays", "majority", "paper"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    rebuild: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    map: str | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    keep_partial: bool = False,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh:
    """Any boolean expression over named meshes, such as ``"a - (b | c) & d"``.

    Keywords, as on the command line:

    - ``preset``: Options that suit printing, scans or parts; those given by hand win.
    - ``method``: How the result is made where surfaces touch or cross (default: auto).
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``orient``: Which side of the triangles is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap (default: positive).
    - ``tolerance``: How far vertices at cracks may move so that these close before anything is called a hole, or ``off`` [default: 0.001%].
    - ``fill``: How holes are closed that a lid over their rim alone closes; others are closed from voxels (default: auto).
    - ``vote``: How rays that disagree are settled (default: winding).
    - ``backend``: Which processor finds the rays' crossings; the result is the same (default: auto).
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``rebuild``: Build the whole surface anew from the voxels, also where the input is right as it is.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``map``: Write the result to this file, coloured by what is kept, cut, rebuilt and made up.
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``keep_partial``: Write the result also when most of the shape is lost (exit status 3); force does so, too.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> ball = mw.read("testdata/hollow_ball.stl")
    >>> mw.csg("a | b", {"a": ball, "b": "testdata/broken_mug.obj"}, resolution=64).validity["open_edges"]
    0
    """
    options: dict[str, Any] = {"preset": preset, "method": method, "resolution": resolution, "voxel": voxel, "orient": orient, "inside": inside, "tolerance": tolerance, "fill": fill, "vote": vote, "backend": backend, "no_collapse": no_collapse, "no_fit": no_fit, "rebuild": rebuild, "simplify": simplify, "drop_smaller": drop_smaller, "map": map, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "keep_partial": keep_partial, "timeout": timeout}
    made, _ = call("csg", meshes, options, expression=expression, result=str(out_format or "ply"), threads=threads, progress=progress)
    return cast(Mesh, made[0])


def dilate(
    mesh: MeshLike,
    *,
    radius: Length,
    preset: Literal["print", "scan", "cad"] | None = None,
    method: Literal["auto", "exact", "voxel"] | None = None,
    resolution: int | None = None,
    voxel: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    tolerance: Length | None = None,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    vote: Literal["winding", "half-rays", "majority", "paper"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    rebuild: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    map: str | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    keep_partial: bool = False,
    timeout: str | float | None = None,
    sharp: bool | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh:
    """Grows a solid by ``radius`` on all sides; a broken mesh is repaired first.

    Keywords, as on the command line:

    - ``radius``: Radius of the ball (0.4mm, 2h for two voxels, 1% of the diagonal).
    - ``preset``: Options that suit printing, scans or parts; those given by hand win.
    - ``method``: How the result is made where surfaces touch or cross (default: auto).
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``orient``: Which side of the triangles is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap (default: positive).
    - ``tolerance``: How far vertices at cracks may move so that these close before anything is called a hole, or ``off`` [default: 0.001%].
    - ``fill``: How holes are closed that a lid over their rim alone closes; others are closed from voxels (default: auto).
    - ``vote``: How rays that disagree are settled (default: winding).
    - ``backend``: Which processor finds the rays' crossings; the result is the same (default: auto).
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``rebuild``: Build the whole surface anew from the voxels, also where the input is right as it is.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``map``: Write the result to this file, coloured by what is kept, cut, rebuilt and made up.
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``keep_partial``: Write the result also when most of the shape is lost (exit status 3); force does so, too.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``sharp``: Keep edges sharp that would become round, up to LIMIT times the radius from where they were.
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> ball = mw.repair("testdata/hollow_ball.stl", resolution=64)
    >>> mw.dilate(ball, radius="2%", resolution=64).volume > ball.volume
    True
    """
    options: dict[str, Any] = {"radius": radius, "preset": preset, "method": method, "resolution": resolution, "voxel": voxel, "orient": orient, "inside": inside, "tolerance": tolerance, "fill": fill, "vote": vote, "backend": backend, "no_collapse": no_collapse, "no_fit": no_fit, "rebuild": rebuild, "simplify": simplify, "drop_smaller": drop_smaller, "map": map, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "keep_partial": keep_partial, "timeout": timeout, "sharp": sharp}
    made, _ = call("dilate", [mesh], options, result=str(out_format or "ply"), threads=threads, progress=progress)
    return cast(Mesh, made[0])


def erode(
    mesh: MeshLike,
    *,
    radius: Length,
    preset: Literal["print", "scan", "cad"] | None = None,
    method: Literal["auto", "exact", "voxel"] | None = None,
    resolution: int | None = None,
    voxel: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    tolerance: Length | None = None,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    vote: Literal["winding", "half-rays", "majority", "paper"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    rebuild: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    map: str | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    keep_partial: bool = False,
    timeout: str | float | None = None,
    sharp: bool | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh:
    """Shrinks a solid by ``radius`` on all sides; a broken mesh is repaired first.

    Keywords, as on the command line:

    - ``radius``: Radius of the ball (0.4mm, 2h for two voxels, 1% of the diagonal).
    - ``preset``: Options that suit printing, scans or parts; those given by hand win.
    - ``method``: How the result is made where surfaces touch or cross (default: auto).
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``orient``: Which side of the triangles is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap (default: positive).
    - ``tolerance``: How far vertices at cracks may move so that these close before anything is called a hole, or ``off`` [default: 0.001%].
    - ``fill``: How holes are closed that a lid over their rim alone closes; others are closed from voxels (default: auto).
    - ``vote``: How rays that disagree are settled (default: winding).
    - ``backend``: Which processor finds the rays' crossings; the result is the same (default: auto).
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``rebuild``: Build the whole surface anew from the voxels, also where the input is right as it is.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``map``: Write the result to this file, coloured by what is kept, cut, rebuilt and made up.
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``keep_partial``: Write the result also when most of the shape is lost (exit status 3); force does so, too.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``sharp``: Keep edges sharp that would become round, up to LIMIT times the radius from where they were.
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> ball = mw.repair("testdata/hollow_ball.stl", resolution=64)
    >>> mw.erode(ball, radius="1%", resolution=64).volume < ball.volume
    True
    """
    options: dict[str, Any] = {"radius": radius, "preset": preset, "method": method, "resolution": resolution, "voxel": voxel, "orient": orient, "inside": inside, "tolerance": tolerance, "fill": fill, "vote": vote, "backend": backend, "no_collapse": no_collapse, "no_fit": no_fit, "rebuild": rebuild, "simplify": simplify, "drop_smaller": drop_smaller, "map": map, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "keep_partial": keep_partial, "timeout": timeout, "sharp": sharp}
    made, _ = call("erode", [mesh], options, result=str(out_format or "ply"), threads=threads, progress=progress)
    return cast(Mesh, made[0])


def open(
    mesh: MeshLike,
    *,
    radius: Length,
    preset: Literal["print", "scan", "cad"] | None = None,
    method: Literal["auto", "exact", "voxel"] | None = None,
    resolution: int | None = None,
    voxel: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    tolerance: Length | None = None,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    vote: Literal["winding", "half-rays", "majority", "paper"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    rebuild: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    map: str | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    keep_partial: bool = False,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh:
    """Takes away what a ball of ``radius`` inside cannot reach: whiskers, fins, thin walls.

    Keywords, as on the command line:

    - ``radius``: Radius of the ball (0.4mm, 2h for two voxels, 1% of the diagonal).
    - ``preset``: Options that suit printing, scans or parts; those given by hand win.
    - ``method``: How the result is made where surfaces touch or cross (default: auto).
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``orient``: Which side of the triangles is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap (default: positive).
    - ``tolerance``: How far vertices at cracks may move so that these close before anything is called a hole, or ``off`` [default: 0.001%].
    - ``fill``: How holes are closed that a lid over their rim alone closes; others are closed from voxels (default: auto).
    - ``vote``: How rays that disagree are settled (default: winding).
    - ``backend``: Which processor finds the rays' crossings; the result is the same (default: auto).
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``rebuild``: Build the whole surface anew from the voxels, also where the input is right as it is.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``map``: Write the result to this file, coloured by what is kept, cut, rebuilt and made up.
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``keep_partial``: Write the result also when most of the shape is lost (exit status 3); force does so, too.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> mw.open("testdata/broken_mug.obj", radius="1%", resolution=64).validity["open_edges"]
    0
    """
    options: dict[str, Any] = {"radius": radius, "preset": preset, "method": method, "resolution": resolution, "voxel": voxel, "orient": orient, "inside": inside, "tolerance": tolerance, "fill": fill, "vote": vote, "backend": backend, "no_collapse": no_collapse, "no_fit": no_fit, "rebuild": rebuild, "simplify": simplify, "drop_smaller": drop_smaller, "map": map, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "keep_partial": keep_partial, "timeout": timeout}
    made, _ = call("open", [mesh], options, result=str(out_format or "ply"), threads=threads, progress=progress)
    return cast(Mesh, made[0])


def close(
    mesh: MeshLike,
    *,
    radius: Length,
    preset: Literal["print", "scan", "cad"] | None = None,
    method: Literal["auto", "exact", "voxel"] | None = None,
    resolution: int | None = None,
    voxel: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    tolerance: Length | None = None,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    vote: Literal["winding", "half-rays", "majority", "paper"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    rebuild: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    map: str | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    keep_partial: bool = False,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh:
    """Fills what a ball of ``radius`` outside cannot reach: cracks, canals, narrow gaps.

    Keywords, as on the command line:

    - ``radius``: Radius of the ball (0.4mm, 2h for two voxels, 1% of the diagonal).
    - ``preset``: Options that suit printing, scans or parts; those given by hand win.
    - ``method``: How the result is made where surfaces touch or cross (default: auto).
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``orient``: Which side of the triangles is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap (default: positive).
    - ``tolerance``: How far vertices at cracks may move so that these close before anything is called a hole, or ``off`` [default: 0.001%].
    - ``fill``: How holes are closed that a lid over their rim alone closes; others are closed from voxels (default: auto).
    - ``vote``: How rays that disagree are settled (default: winding).
    - ``backend``: Which processor finds the rays' crossings; the result is the same (default: auto).
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``rebuild``: Build the whole surface anew from the voxels, also where the input is right as it is.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``map``: Write the result to this file, coloured by what is kept, cut, rebuilt and made up.
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``keep_partial``: Write the result also when most of the shape is lost (exit status 3); force does so, too.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> mw.close("testdata/broken_mug.obj", radius="1%", resolution=64).validity["open_edges"]
    0
    """
    options: dict[str, Any] = {"radius": radius, "preset": preset, "method": method, "resolution": resolution, "voxel": voxel, "orient": orient, "inside": inside, "tolerance": tolerance, "fill": fill, "vote": vote, "backend": backend, "no_collapse": no_collapse, "no_fit": no_fit, "rebuild": rebuild, "simplify": simplify, "drop_smaller": drop_smaller, "map": map, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "keep_partial": keep_partial, "timeout": timeout}
    made, _ = call("close", [mesh], options, result=str(out_format or "ply"), threads=threads, progress=progress)
    return cast(Mesh, made[0])


def canals(
    mesh: MeshLike,
    *,
    max_diameter: Length,
    remove: bool | str | Sequence[int] | None = None,
    preset: Literal["print", "scan", "cad"] | None = None,
    method: Literal["auto", "exact", "voxel"] | None = None,
    resolution: int | None = None,
    voxel: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    tolerance: Length | None = None,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    vote: Literal["winding", "half-rays", "majority", "paper"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    rebuild: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    map: str | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    keep_partial: bool = False,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> tuple[list[dict[str, Any]], Mesh | None]:
    """Lists canals, pits and gaps that a closing would fill, and fills those that ``remove`` names. Returns the list, one dictionary each as in the
    report, and the mesh with these filled, or ``None`` without ``remove``.

    Keywords, as on the command line:

    - ``max_diameter``: Canals that a ball of this diameter does not pass are listed, by number.
    - ``remove``: Fill these canals and write the rest as it was: ``all``, or numbers such as 1,3.
    - ``preset``: Options that suit printing, scans or parts; those given by hand win.
    - ``method``: How the result is made where surfaces touch or cross (default: auto).
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``orient``: Which side of the triangles is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap (default: positive).
    - ``tolerance``: How far vertices at cracks may move so that these close before anything is called a hole, or ``off`` [default: 0.001%].
    - ``fill``: How holes are closed that a lid over their rim alone closes; others are closed from voxels (default: auto).
    - ``vote``: How rays that disagree are settled (default: winding).
    - ``backend``: Which processor finds the rays' crossings; the result is the same (default: auto).
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``rebuild``: Build the whole surface anew from the voxels, also where the input is right as it is.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``map``: Write the result to this file, coloured by what is kept, cut, rebuilt and made up.
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``keep_partial``: Write the result also when most of the shape is lost (exit status 3); force does so, too.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> found, mesh = mw.canals("testdata/broken_mug.obj", max_diameter="5%", resolution=64)
    >>> mesh is None
    True
    """
    options: dict[str, Any] = {"max_diameter": max_diameter, "remove": remove, "preset": preset, "method": method, "resolution": resolution, "voxel": voxel, "orient": orient, "inside": inside, "tolerance": tolerance, "fill": fill, "vote": vote, "backend": backend, "no_collapse": no_collapse, "no_fit": no_fit, "rebuild": rebuild, "simplify": simplify, "drop_smaller": drop_smaller, "map": map, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "keep_partial": keep_partial, "timeout": timeout}
    made, report = call("canals", [mesh], options, result=None if remove is None or remove is False else str(out_format or "ply"), threads=threads, progress=progress)
    found = report["result"]["pipeline"]["canals"]["canals"]
    return found, made[0] if made else None


def thicken(
    mesh: MeshLike,
    *,
    min: Length | None = None,
    side: Literal["both", "front", "back"] | None = None,
    base: Length | None = None,
    preset: Literal["print", "scan", "cad"] | None = None,
    method: Literal["auto", "exact", "voxel"] | None = None,
    resolution: int | None = None,
    voxel: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    tolerance: Length | None = None,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    vote: Literal["winding", "half-rays", "majority", "paper"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    rebuild: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    map: str | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    keep_partial: bool = False,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh:
    """Lets walls that are too thin, and open sheets, grow to a thickness; with ``base`` makes a block of an open sheet.

    Keywords, as on the command line:

    - ``min``: The least thickness of walls, at least four voxels.
    - ``side``: Where open sheets grow (default: both).
    - ``base``: Make a block of an open sheet, such as terrain: walls from its rims down to a flat base so far below its lowest point, or in a plane
      (z=-5mm).
    - ``preset``: Options that suit printing, scans or parts; those given by hand win.
    - ``method``: How the result is made where surfaces touch or cross (default: auto).
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``orient``: Which side of the triangles is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap (default: positive).
    - ``tolerance``: How far vertices at cracks may move so that these close before anything is called a hole, or ``off`` [default: 0.001%].
    - ``fill``: How holes are closed that a lid over their rim alone closes; others are closed from voxels (default: auto).
    - ``vote``: How rays that disagree are settled (default: winding).
    - ``backend``: Which processor finds the rays' crossings; the result is the same (default: auto).
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``rebuild``: Build the whole surface anew from the voxels, also where the input is right as it is.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``map``: Write the result to this file, coloured by what is kept, cut, rebuilt and made up.
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``keep_partial``: Write the result also when most of the shape is lost (exit status 3); force does so, too.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> sheet = ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> bool(abs(mw.thicken(sheet, base=0.5).volume - 0.5) < 1e-9)
    True
    """
    options: dict[str, Any] = {"min": min, "side": side, "base": base, "preset": preset, "method": method, "resolution": resolution, "voxel": voxel, "orient": orient, "inside": inside, "tolerance": tolerance, "fill": fill, "vote": vote, "backend": backend, "no_collapse": no_collapse, "no_fit": no_fit, "rebuild": rebuild, "simplify": simplify, "drop_smaller": drop_smaller, "map": map, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "keep_partial": keep_partial, "timeout": timeout}
    made, _ = call("thicken", [mesh], options, result=str(out_format or "ply"), threads=threads, progress=progress)
    return cast(Mesh, made[0])


def hollow(
    mesh: MeshLike,
    *,
    wall: Length,
    drain: str | Sequence[str] | None = None,
    preset: Literal["print", "scan", "cad"] | None = None,
    method: Literal["auto", "exact", "voxel"] | None = None,
    resolution: int | None = None,
    voxel: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    tolerance: Length | None = None,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    vote: Literal["winding", "half-rays", "majority", "paper"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    rebuild: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    map: str | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    keep_partial: bool = False,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh:
    """Shells a solid out: a cavity in it, walls of one thickness, and holes to drain it.

    Keywords, as on the command line:

    - ``wall``: Thickness of the wall that stays, at least two voxels.
    - ``drain``: Drill a round hole of diameter D into the cavity, from the place of the surface that is nearest to x,y,z; may be given again.
    - ``preset``: Options that suit printing, scans or parts; those given by hand win.
    - ``method``: How the result is made where surfaces touch or cross (default: auto).
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``orient``: Which side of the triangles is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap (default: positive).
    - ``tolerance``: How far vertices at cracks may move so that these close before anything is called a hole, or ``off`` [default: 0.001%].
    - ``fill``: How holes are closed that a lid over their rim alone closes; others are closed from voxels (default: auto).
    - ``vote``: How rays that disagree are settled (default: winding).
    - ``backend``: Which processor finds the rays' crossings; the result is the same (default: auto).
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``rebuild``: Build the whole surface anew from the voxels, also where the input is right as it is.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``map``: Write the result to this file, coloured by what is kept, cut, rebuilt and made up.
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``keep_partial``: Write the result also when most of the shape is lost (exit status 3); force does so, too.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> ball = mw.dilate("testdata/hollow_ball.stl", radius="5%", resolution=64)
    >>> mw.hollow(ball, wall="5%", resolution=64).volume < ball.volume
    True
    """
    options: dict[str, Any] = {"wall": wall, "drain": drain, "preset": preset, "method": method, "resolution": resolution, "voxel": voxel, "orient": orient, "inside": inside, "tolerance": tolerance, "fill": fill, "vote": vote, "backend": backend, "no_collapse": no_collapse, "no_fit": no_fit, "rebuild": rebuild, "simplify": simplify, "drop_smaller": drop_smaller, "map": map, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "keep_partial": keep_partial, "timeout": timeout}
    made, _ = call("hollow", [mesh], options, result=str(out_format or "ply"), threads=threads, progress=progress)
    return cast(Mesh, made[0])


def decimate(
    mesh: MeshLike,
    *,
    triangles: int | None = None,
    ratio: float | None = None,
    max_deviation: Length | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh:
    """Leaves fewer triangles of a valid solid: a number, a share, or as many as the surface may move.

    Keywords, as on the command line:

    - ``triangles``: Leave no more triangles than this.
    - ``ratio``: Leave this share of the triangles: 0.1, or 10%.
    - ``max_deviation``: How far the surface may move, measured both ways (0.1mm, 0.05%).
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> ball = mw.repair("testdata/hollow_ball.stl", resolution=64)
    >>> len(mw.decimate(ball, ratio=0.5).faces) <= len(ball.faces) / 2
    True
    """
    options: dict[str, Any] = {"triangles": triangles, "ratio": ratio, "max_deviation": max_deviation, "in_format": in_format, "unit": unit, "out_format": out_format, "timeout": timeout}
    made, _ = call("decimate", [mesh], options, result=str(out_format or "ply"), threads=threads, progress=progress)
    return cast(Mesh, made[0])


def sdf(
    mesh: MeshLike,
    *,
    resolution: int | None = None,
    voxel: Length | None = None,
    band: Length | None = None,
    planes: str | Sequence[int] | None = None,
    method: Literal["exact", "characteristics", "prism", "robust"] | None = None,
    backend: Literal["auto", "cpu", "gpu"] | None = None,
    sign: Literal["votes", "pseudonormal", "winding", "levels"] | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Grid:
    """The signed distance to a mesh over a lattice, negative inside. At points of your own: :func:`meshwright.signed_distance`.

    Keywords, as on the command line:

    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``band``: How far from the surface distances are found, or ``full`` for everywhere; the lattice reaches as far (default: 4h).
    - ``planes``: Only these planes of z of the lattice, from the first (a multiple of 8) on and before the second: the values are those of the whole.
    - ``method``: How the distance is found (default: exact).
    - ``backend``: Which processor measures: ``auto`` is the main one; ``gpu`` a graphics adapter, for method exact, the same but for rounding
      (default: auto).
    - ``sign``: What tells inside from outside [default: pseudonormal for a valid solid, else votes].
    - ``orient``: Which side of the triangles is outside, unless the sign is by pseudonormals: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces lie in each other or overlap, unless the sign is by pseudonormals (default:
      positive).
    - ``max_memory``: Refuse to start when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> grid = mw.sdf("testdata/hollow_ball.stl", resolution=32, band="full")
    >>> grid.values.dtype, grid.values.ndim
    (dtype('float32'), 3)
    """
    options: dict[str, Any] = {"resolution": resolution, "voxel": voxel, "band": band, "planes": planes, "method": method, "backend": backend, "sign": sign, "orient": orient, "inside": inside, "max_memory": max_memory, "in_format": in_format, "unit": unit, "timeout": timeout}
    made, _ = call("sdf", [mesh], options, result="nrrd", threads=threads, progress=progress)
    return cast(Grid, made[0])


def field(
    expression: str,
    meshes: Mapping[str,
    MeshLike],
    *,
    grid: bool = False,
    resolution: int | None = None,
    voxel: Length | None = None,
    band: Length | None = None,
    frames: int | None = None,
    paint: str | None = None,
    paint_range: str | Sequence[float] | None = None,
    no_collapse: bool = False,
    no_fit: bool = False,
    simplify: Length | None = None,
    drop_smaller: Length | None = None,
    orient: Literal["auto", "keep"] | None = None,
    inside: Literal["positive", "nonzero", "odd"] | None = None,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    out_format: str | None = None,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> Mesh | Grid | list[Any]:
    """Combines, filters and morphs shapes through their distance fields, by an expression in the language of ``docs/field.md``.

    Keywords, as on the command line:

    - ``grid``: Return the values over a lattice, a :class:``Grid``, instead of the surface.
    - ``resolution``: Voxels along the longest side of the bounding box (default: 256).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``band``: How far from zero a lattice has the values, or ``full`` for all of them [default: 4h, and full for what is no shape].
    - ``frames``: Write this many results, in which ``t`` goes from 0 to 1; their numbers are put into the name.
    - ``paint``: Colour the vertices by the value of this expression over the same names.
    - ``paint_range``: Values of paint from which on the first and the last colour stand [default: the least and the greatest there are].
    - ``no_collapse``: Keep the vertices of every voxel apart: more triangles.
    - ``no_fit``: Leave edges and corners as the voxels have them, and all triangles.
    - ``simplify``: How far flat parts may move while triangles are saved, or ``off`` to keep all [default: 0.002h].
    - ``drop_smaller``: Leave out closed surfaces that enclose less (8h3 for cubic voxels, 0.5mm3).
    - ``orient``: Which side of the triangles of broken meshes is outside: find out, or trust the file (default: auto).
    - ``inside``: Which part of space is inside where closed surfaces of a broken mesh lie in each other or overlap (default: positive).
    - ``max_memory``: Refuse when more memory would be needed (500M, 2G) [default: what is free].
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``out_format``: Format of the output, when its name should not decide.
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> mw.field("offset(a, 2%)", {"a": "testdata/hollow_ball.stl"}, resolution=64).validity["open_edges"]
    0
    """
    options: dict[str, Any] = {"resolution": resolution, "voxel": voxel, "band": band, "frames": frames, "paint": paint, "paint_range": paint_range, "no_collapse": no_collapse, "no_fit": no_fit, "simplify": simplify, "drop_smaller": drop_smaller, "orient": orient, "inside": inside, "max_memory": max_memory, "in_format": in_format, "unit": unit, "out_format": out_format, "timeout": timeout}
    result = "nrrd" if grid else str(out_format or "ply")
    made, _ = call("field", meshes, options, expression=expression, result=result, threads=threads, progress=progress)
    return made if frames is not None else cast(Mesh, made[0])


def inspect(
    mesh: MeshLike,
    *,
    overhang: float | None = None,
    thickness: bool = False,
    holes: bool = False,
    fill: Literal["auto", "flat", "smooth", "none"] | None = None,
    voxel: Length | None = None,
    fail_on: str | Sequence[str] | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    timeout: str | float | None = None,
    resolution: int | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> dict[str, Any]:
    """Says what is in a mesh and what is wrong with it: the report as ``--json`` prints it.

    Keywords, as on the command line:

    - ``overhang``: Surface that faces down and is steeper than this against the vertical hangs over, degrees; z is up (default: 45).
    - ``thickness``: Also measure the thickness of walls and gaps along the rays of a lattice.
    - ``holes``: Also list the holes, with what ``repair`` would do over each.
    - ``fill``: How the holes would be closed (default: auto).
    - ``voxel``: Size of a voxel, instead of resolution.
    - ``fail_on``: Exit with 3 when the mesh has one of these defects.
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``timeout``: Give up after this time (30s, 5m).
    - ``resolution``: Voxels along the longest side of the bounding box, of thickness and of the repair that is foretold (default: 256).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> report = mw.inspect("testdata/broken_mug.obj")
    >>> report["inputs"][0]["validity"]["open_edges"] > 0
    True
    """
    options: dict[str, Any] = {"overhang": overhang, "thickness": thickness, "holes": holes, "fill": fill, "voxel": voxel, "fail_on": fail_on, "in_format": in_format, "unit": unit, "timeout": timeout, "resolution": resolution}
    _, report = call("inspect", [mesh], options, result=None, threads=threads, progress=progress)
    return report


def compare(
    a: MeshLike,
    b: MeshLike,
    *,
    map: str | None = None,
    map_range: Length | None = None,
    samples: int | None = None,
    tolerance: Length | None = None,
    fail_on_max: Length | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> dict[str, Any]:
    """Measures how far two meshes are from each other, model units; the second is judged by the first.

    Keywords, as on the command line:

    - ``map``: Write B, coloured by its signed distance from A, to this file.
    - ``map_range``: The distance that has the full colour in the map [default: what 99 of 100 vertices do not exceed].
    - ``samples``: Points on each mesh at which distances are taken, besides all vertices (default: 100000).
    - ``tolerance``: How near a sharp edge of the other mesh must be to count as found [default: 1/1024 of A's longest side].
    - ``fail_on_max``: Exit with 3 when a point of one mesh is farther than this from the other.
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> mw.compare("testdata/hollow_ball.stl", "testdata/hollow_ball.stl")["symmetric"]["max"]
    0.0
    """
    options: dict[str, Any] = {"map": map, "map_range": map_range, "samples": samples, "tolerance": tolerance, "fail_on_max": fail_on_max, "in_format": in_format, "unit": unit, "timeout": timeout}
    _, report = call("compare", [a, b], options, result=None, threads=threads, progress=progress)
    return cast("dict[str, Any]", report["result"]["comparison"])


def render(
    mesh: MeshLike,
    after: MeshLike | None = None,
    *,
    width: int | None = None,
    height: int | None = None,
    view: str | None = None,
    views: str | Sequence[str] | None = None,
    projection: Literal["orthographic", "perspective"] | None = None,
    y_up: bool = False,
    slice: Length | None = None,
    clip: Length | None = None,
    opacity: str | float | None = None,
    zoom: Literal["defects"] | None = None,
    regions: str | None = None,
    edges: Literal["none", "sharp", "all"] | None = None,
    no_defects: bool = False,
    background: Literal["gradient", "white", "transparent"] | None = None,
    title: str | Sequence[str] | None = None,
    plain: bool = False,
    max_memory: str | int | None = None,
    in_format: str | None = None,
    unit: str | None = None,
    timeout: str | float | None = None,
    threads: int | None = None,
    progress: Progress = False,
) -> NDArray[np.uint8]:
    """Draws a mesh, or two of them beside each other: red, green, blue and alpha of each pixel, shape (height, width, 4).

    Keywords, as on the command line:

    - ``width``: Width of the picture (of each, for several), pixels (default: 1200).
    - ``height``: Height, pixels (default: 900).
    - ``view``: From where: iso, front, back, left, right, top, bottom, or the direction to the viewer as X,Y,Z (default: iso).
    - ``views``: Several views on one sheet, in one scale: iso,front,top,right.
    - ``projection``: How depth shows (default: orthographic).
    - ``y_up``: The y axis points up, not z; in slices, too.
    - ``slice``: Draw a slice: z (through the middle), x=50%, y=1.5 or z=2mm; of meshes, where no grid is given, through their signed distance
      [default: z, for grids].
    - ``clip``: Cut away what is in front of a plane: z=50%, x=1.5 or y=2mm; the inside of closed meshes is hatched.
    - ``opacity``: How much a surface hides of what is behind it: 0.3, or 30% (default: 1).
    - ``zoom``: Fill the picture with this: the largest group of defects.
    - ``regions``: Draw the thin and doubtful regions that the report of a run tells of.
    - ``edges``: Which edges of triangles are drawn (default: sharp).
    - ``no_defects``: Do not colour defects.
    - ``background``: What is behind the mesh (default: gradient).
    - ``title``: The words above the picture; once for each, for several [default: the names of the files].
    - ``plain``: No title, axes, scale and legend: the mesh alone.
    - ``max_memory``: Refuse grids that would take more memory (500M, 2G).
    - ``in_format``: Format of the input, when neither its content nor its name should decide.
    - ``unit``: Unit of the numbers in files that carry none (STL, OBJ, PLY, OFF).
    - ``timeout``: Give up after this time (30s, 5m).
    - ``threads``: Threads to use; without it those that all calls share, one for each core.
    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1.

    >>> import meshwright as mw
    >>> mw.render("testdata/broken_mug.obj", width=64, height=48).shape
    (48, 64, 4)
    """
    options: dict[str, Any] = {"width": width, "height": height, "view": view, "views": views, "projection": projection, "y_up": y_up, "slice": slice, "clip": clip, "opacity": opacity, "zoom": zoom, "regions": regions, "edges": edges, "no_defects": no_defects, "background": background, "title": title, "plain": plain, "max_memory": max_memory, "in_format": in_format, "unit": unit, "timeout": timeout}
    made, _ = call("render", [mesh] if after is None else [mesh, after], options, result="png", threads=threads, progress=progress)
    return cast("NDArray[np.uint8]", made[0])
