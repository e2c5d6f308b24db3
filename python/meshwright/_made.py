"""What comes back: meshes and lattices of values."""

from __future__ import annotations

import base64
import html
import json
import os
import struct
import zlib
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _native
from .errors import failure

if TYPE_CHECKING:
    import open3d
    import pyvista
    import trimesh

__all__ = ["KINDS", "Colours", "Grid", "Mesh", "Part"]

#: What the numbers of :attr:`Mesh.kinds` mean.
KINDS = ("kept", "rebuilt", "made up", "cut")


class Colours(NamedTuple):
    """Colours of a mesh."""

    #: What they belong to: ``"face"``, ``"vertex"`` or ``"corner"``.
    of: str
    #: Red, green, blue, alpha: uint8, shape (m, 4) for faces, (n, 4) for vertices, (m, 3, 4) for the corners of faces.
    rgba: NDArray[np.uint8]


class Part(NamedTuple):
    """A named piece of a file."""

    #: The name in the file; empty where it has none.
    name: str
    #: Its faces, as a slice of :attr:`Mesh.faces`.
    faces: slice


class Mesh:
    """A triangle mesh. What functions of this module return is one; any other mesh becomes one by :func:`meshwright.read` or by this class.

    >>> import numpy as np, meshwright as mw
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    >>> mesh = mw.Mesh(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    >>> mesh
    <meshwright.Mesh: 4 vertices, 4 faces>
    """

    #: Places of the vertices, model units: float64, shape (n, 3).
    vertices: NDArray[np.float64]
    #: The vertices of each triangle, counter-clockwise seen from outside: uint32, shape (m, 3).
    faces: NDArray[np.uint32]
    #: Where each triangle comes from: int64, shape (m, 2): the number of the input and of its triangle, or -1 and -1 for what was made up. ``None``
    #: where it is not known.
    sources: NDArray[np.int64] | None
    #: What each triangle is, a number of :data:`meshwright.KINDS`: uint8, shape (m,). ``None`` where it is not known.
    kinds: NDArray[np.uint8] | None
    #: Its colours, or ``None``.
    colours: Colours | None
    #: The report of the run that made it, as ``--json`` prints it; empty for a mesh that was only read.
    report: dict[str, Any]
    #: The unit of the coordinates (``"um"``, ``"mm"``, ``"cm"``, ``"in"``, ``"ft"``, ``"m"``), or ``None``.
    unit: str | None
    #: The named pieces of the file that it was read from.
    parts: list[Part]
    #: What is known of it, as in the reports: counts, defects, volume (cubic model units), area. Empty where it was not examined.
    validity: dict[str, Any]

    def __init__(self, vertices: Any, faces: Any, *, unit: str | None = None, colours: Colours | None = None) -> None:
        self.vertices = np.asarray(vertices, dtype=np.float64)
        self.faces = np.asarray(faces)
        self.unit = unit
        self.colours = colours
        self.sources = None
        self.kinds = None
        self.report = {}
        self.parts = []
        self.validity = {}
        self._texture: _native.Texture | None = None

    @classmethod
    def _of(cls, product: dict[str, Any], report: dict[str, Any]) -> Mesh:
        colours = product.get("colours")
        mesh = cls(
            product["vertices"],
            product["faces"],
            unit=product.get("unit"),
            colours=Colours(*colours) if colours else None,
        )
        mesh.sources = product.get("sources")
        mesh.kinds = product.get("kinds")
        mesh.report = report
        mesh.parts = [Part(name, slice(start, end)) for name, start, end in product.get("parts", [])]
        mesh.validity = json.loads(product["validity"]) if "validity" in product else {}
        mesh._texture = product.get("texture")
        return mesh

    @property
    def volume(self) -> float:
        """The volume that the triangles enclose, cubic model units; of an open mesh what its triangles and the origin make."""
        a, b, c = np.moveaxis(self.vertices[self.faces], 1, 0)
        return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)

    def __repr__(self) -> str:
        return f"<meshwright.Mesh: {self._facts()}>"

    def _facts(self) -> str:
        facts = [f"{len(self.vertices):,} vertices", f"{len(self.faces):,} faces"]
        if self.validity:
            unit = f" {self.unit}³" if self.unit else ""
            facts += ["closed" if self.validity.get("open_edges") == 0 else "open", f"volume {self.volume:.6g}{unit}"]
        return ", ".join(facts)

    def _repr_html_(self) -> str:
        """In a notebook: a picture and a line of facts."""
        facts = html.escape(self._facts())
        if not len(self.faces):
            return f"<div>{facts}</div>"
        from .verbs import render

        picture = base64.b64encode(_png(render(self, width=480, height=360))).decode()
        return f'<div><img alt="{facts}" src="data:image/png;base64,{picture}"/><br/>{facts}</div>'

    def to_trimesh(self) -> trimesh.Trimesh:
        """The same as a ``trimesh.Trimesh``, with colours; vertices and faces keep their order."""
        import trimesh

        kind = {"face": "face_colors", "vertex": "vertex_colors"}.get(self.colours.of) if self.colours else None
        colours: dict[str, Any] = {kind: self.colours.rgba} if kind and self.colours else {}
        mesh = trimesh.Trimesh(self.vertices, self.faces, process=False, **colours)
        if self.unit:
            mesh.units = self.unit
        return mesh

    def to_pyvista(self) -> pyvista.PolyData:
        """The same as a ``pyvista.PolyData``, with ``kinds``, ``sources`` and ``colours`` as arrays of its cells or points."""
        import pyvista

        mesh: pyvista.PolyData = pyvista.PolyData.from_regular_faces(self.vertices, self.faces.astype(int))
        for name in ("kinds", "sources"):
            if getattr(self, name) is not None:
                mesh.cell_data[name] = getattr(self, name)
        if self.colours and self.colours.of != "corner":
            data = mesh.cell_data if self.colours.of == "face" else mesh.point_data
            data["colours"] = self.colours.rgba
        return mesh

    def to_open3d(self) -> open3d.geometry.TriangleMesh:
        """The same as an ``open3d.geometry.TriangleMesh``; colours only of vertices."""
        import open3d

        vertices = open3d.utility.Vector3dVector(self.vertices)
        mesh = open3d.geometry.TriangleMesh(vertices, open3d.utility.Vector3iVector(self.faces.astype(np.int32)))
        if self.colours and self.colours.of == "vertex":
            mesh.vertex_colors = open3d.utility.Vector3dVector(self.colours.rgba[:, :3] / 255.0)
        return mesh

    def write(self, path: str | os.PathLike[str], **options: Any) -> None:
        """Writes the mesh: :func:`meshwright.write`."""
        from .asked import write

        write(self, path, **options)


def _png(pixels: NDArray[np.uint8]) -> bytes:
    """The bytes of a PNG file of these pixels: uint8, shape (height, width, 4)."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width, _ = pixels.shape
    rows = np.hstack([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)])
    head = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    body = zlib.compress(rows.tobytes(), 6)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) + chunk(b"IEND", b"")


class Grid:
    """Values over a lattice: a signed distance, or what an expression has made of some.

    The value at ``values[i, j, k]`` belongs to the place ``origin + spacing * (i, j, k)``.
    """

    #: The values, model units, negative inside: float32, shape (nx, ny, nz).
    values: NDArray[np.float32]
    #: The place of ``values[0, 0, 0]``, model units.
    origin: tuple[float, float, float]
    #: The distance between neighbours, model units.
    spacing: float
    #: How far from the surface the values are distances; beyond, they are this and its negative. ``None``: everywhere.
    band: float | None
    #: The unit of all lengths, or ``None``.
    unit: str | None
    #: The report of the run that made it.
    report: dict[str, Any]

    def __init__(
        self,
        values: NDArray[np.float32],
        origin: Any,
        spacing: float,
        band: float | None = None,
        unit: str | None = None,
        report: dict[str, Any] | None = None,
    ) -> None:
        self.values = values
        x, y, z = origin
        self.origin = (float(x), float(y), float(z))
        self.spacing = spacing
        self.band = band
        self.unit = unit
        self.report = report or {}

    def __repr__(self) -> str:
        x, y, z = self.values.shape
        return f"<meshwright.Grid: {x} x {y} x {z} values, {self.spacing:.6g} apart>"

    def axes(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """The coordinates of the values along x, y and z, model units."""
        x, y, z = self.values.shape
        ax, ay, az = (start + self.spacing * np.arange(n) for start, n in zip(self.origin, (x, y, z)))
        return ax, ay, az

    def to_pyvista(self) -> pyvista.ImageData:
        """The same as a ``pyvista.ImageData`` whose points have the array ``distance``."""
        import pyvista

        grid = pyvista.ImageData(
            dimensions=self.values.shape, spacing=(self.spacing,) * 3, origin=self.origin
        )
        grid.point_data["distance"] = self.values.ravel(order="F")
        return grid

    def write(self, path: str | os.PathLike[str], *, out_format: str | None = None) -> None:
        """Writes the values as VTI, NRRD, NPY or VDB, as the name or ``out_format`` says."""
        values = np.asarray(self.values, dtype=np.float32).T
        failed = _native.write_grid(path, values, (self.origin, self.spacing, self.band), self.unit, out_format)
        if failed is not None:
            raise failure(failed)
