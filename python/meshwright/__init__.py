"""Repairs triangle meshes and does solid modelling on meshes as they really are: open, cracked, self-intersecting, flipped, doubled.

>>> import meshwright as mw
>>> mug = mw.repair("testdata/broken_mug.obj", resolution=64)     # or a trimesh, a PyVista mesh, (vertices, faces) ...
>>> mug.vertices.shape[1], mug.faces.shape[1]
(3, 3)
>>> both = mw.union(mug, "testdata/hollow_ball.stl", resolution=64)
>>> distances = mw.signed_distance(both, [[0, 0, 0], [0, 0, 100]])

A mesh is anything with ``vertices`` and ``faces``, a pair of arrays, or a path. Keywords are the flags of the command line with underscores, with the
same words and defaults. Lengths are in model units where they are numbers; ``"0.4mm"``, ``"1%"`` (of the diagonal) and ``"2h"`` (voxels) work, too.
Signed distances are negative inside.
"""

from ._made import KINDS, Colours, Grid, Mesh, Part
from ._native import __version__
from .asked import ClosestPoints, closest_point, contains, plan, read, signed_distance, write
from .errors import *  # noqa: F403
from .errors import __all__ as _errors
from .verbs import *  # noqa: F403
from .verbs import __all__ as _verbs

__all__ = [
    "KINDS",
    "ClosestPoints",
    "Colours",
    "Grid",
    "Mesh",
    "Part",
    "__version__",
    "closest_point",
    "contains",
    "plan",
    "read",
    "signed_distance",
    "write",
]
__all__ += _errors
__all__ += _verbs
