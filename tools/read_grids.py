#!/usr/bin/env python3
"""The grids that we write, read by VTK, pynrrd, NumPy and OpenVDB; and those that they write, read by us.

    tools/read_grids.py PROGRAM [--install]

Needs vtk, pynrrd and numpy here, and OpenVDB's Python module, which Debian has as python3-openvdb for /usr/bin/python3.
With --install it installs what is missing with pip and apt-get. Anything that differs is an error.
"""
import argparse
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DEBIAN_PYTHON = "/usr/bin/python3"
MODULES = {"numpy": "numpy", "nrrd": "pynrrd", "vtkmodules": "vtk"}


def install():
    missing = [package for module, package in MODULES.items() if importlib.util.find_spec(module) is None]
    if missing:
        pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        subprocess.run(pip + missing, check=True)
    if subprocess.run([DEBIAN_PYTHON, "-c", "import numpy, pyopenvdb"], capture_output=True).returncode:
        sudo = [] if os.geteuid() == 0 else ["sudo"]
        subprocess.run(sudo + ["apt-get", "update", "-qq"], check=True)
        packages = ["python3-openvdb", "python3-numpy"]
        subprocess.run(sudo + ["apt-get", "install", "-y", "-qq", "--no-install-recommends"] + packages, check=True)


def with_openvdb(verb, *arguments):
    """Runs a function of this file in the interpreter that has OpenVDB, and returns what it prints."""
    command = [DEBIAN_PYTHON, __file__, "--openvdb", verb, *map(str, arguments)]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def openvdb_read(source, values, dims):
    """Says what OpenVDB reads in a file, and saves the values of the first `dims` voxels as an array."""
    import numpy as np
    import pyopenvdb as vdb

    grids, about = vdb.readAll(source)
    [grid] = grids
    array = np.empty(json.loads(dims), np.float32)
    grid.copyToArray(array, ijk=(0, 0, 0))
    np.save(values, array)
    corners = [grid.transform.indexToWorld(p) for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))]
    points, quads = grid.convertToQuads()
    return {
        "name": grid.name, "class": grid.gridClass, "background": grid.background, "corners": corners,
        "metadata": {key: value for key, value in grid.metadata.items()}, "about": about,
        "active": grid.activeVoxelCount(), "leaves": grid.leafCount(), "tiles_active": grid.activeVoxelCount() - sum(
            1 for item in grid.citerOnValues() if item.count == 1),
        "points": points.tolist(), "quads": quads.tolist(),
    }


def openvdb_write(values, spacing, origin, background, plain, half):
    """Writes an array as a level set, as it is (OpenVDB then compresses by Blosc), and in 16 bits."""
    import numpy as np
    import pyopenvdb as vdb

    spacing, origin, background = float(spacing), json.loads(origin), float(background)
    grid = vdb.FloatGrid(background)
    grid.copyFromArray(np.load(values))
    grid.gridClass, grid.name = vdb.GridClass.LEVEL_SET, "surface"
    grid.transform = vdb.createLinearTransform(voxelSize=spacing)
    grid.transform.translate(origin)
    grid.signedFloodFill()
    vdb.write(plain, grids=[grid])
    grid.saveFloatAsHalf = True
    vdb.write(half, grids=[grid])
    return {}


def vtk_read(source):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader

    reader = vtkXMLImageDataReader()
    reader.SetFileName(str(source))
    reader.Update()
    image = reader.GetOutput()
    array = image.GetPointData().GetScalars()
    fields = image.GetFieldData()
    words = {name: fields.GetAbstractArray(name).GetValue(0) for name in ("band", "unit", "sign")}
    values = vtk_to_numpy(array).reshape(image.GetDimensions(), order="F")
    return values, array.GetName(), image.GetOrigin(), image.GetSpacing(), words


def vtk_write(values, origin, spacing, folder):
    """The array in every way that VTK writes one; yields the files."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    image = vtkImageData()
    image.SetDimensions(values.shape)
    image.SetOrigin(origin)
    image.SetSpacing(spacing, spacing, spacing)
    array = numpy_to_vtk(values.ravel(order="F"), deep=True)
    array.SetName("d")
    image.GetPointData().SetScalars(array)
    for mode, big, zlib, wide, encoded in [
        ("Ascii", 0, 0, 0, 0), ("Binary", 0, 0, 1, 0), ("Binary", 1, 1, 0, 0), ("Appended", 0, 0, 0, 1),
        ("Appended", 1, 0, 1, 0), ("Appended", 0, 1, 1, 1), ("Appended", 0, 1, 0, 0),
    ]:
        writer = vtkXMLImageDataWriter()
        path = folder / f"vtk-{mode}-{big}{zlib}{wide}{encoded}.vti"
        writer.SetFileName(str(path))
        writer.SetInputData(image)
        getattr(writer, f"SetDataModeTo{mode}")()
        getattr(writer, "SetByteOrderToBigEndian" if big else "SetByteOrderToLittleEndian")()
        getattr(writer, "SetHeaderTypeToUInt64" if wide else "SetHeaderTypeToUInt32")()
        getattr(writer, "SetCompressorTypeToZLib" if zlib else "SetCompressorTypeToNone")()
        writer.SetEncodeAppendedData(encoded)
        assert writer.Write() == 1, path
        yield path


def nrrd_write(values, origin, spacing, folder):
    import nrrd
    import numpy as np

    header = {"space dimension": 3, "space directions": np.eye(3) * spacing, "space origin": np.array(origin)}
    for encoding in ("raw", "gzip", "ascii"):
        for kind in ("<f4", ">f8"):
            path = folder / f"nrrd-{encoding}-{kind[1:]}.nrrd"
            nrrd.write(str(path), values.astype(kind), {**header, "encoding": encoding})
            yield path


def close(a, b, what):
    import numpy as np

    assert np.allclose(a, b, rtol=1e-7, atol=1e-9), f"{what}: {a} and {b}"


def check_ours(folder, report):
    """What the others read in our files; returns the values, the origin and the spacing."""
    import nrrd
    import numpy as np

    distance = report["result"]["distance"]
    origin, spacing, dims, band = (distance[key] for key in ("origin", "voxel", "dims", "band"))
    values = np.load(folder / "f.npy")
    assert values.shape == tuple(dims) and values.dtype == np.float32 and values.flags["F_CONTIGUOUS"]
    assert (values < 0).sum() == distance["inside"]

    read, header = nrrd.read(str(folder / "f.nrrd"))
    assert (read == values).all()
    close(header["space directions"], np.eye(3) * spacing, "spacing of NRRD")
    close(header["space origin"], origin, "origin of NRRD")
    assert header["space units"] == ["mm"] * 3 and header["sign"] == "negative inside", header

    read, name, *place, words = vtk_read(folder / "f.vti")
    assert (read == values).all() and name == "signed_distance"
    close(place, [origin, [spacing] * 3], "place of VTI")
    assert words == {"band": band, "unit": "mm", "sign": "negative inside"}, words

    seen = with_openvdb("read", folder / "f.vdb", folder / "from_vdb.npy", json.dumps(dims))
    assert (np.load(folder / "from_vdb.npy") == values).all()
    assert (seen["name"], seen["class"]) == ("surface", "level set"), seen
    close(seen["background"], band, "background of VDB")
    first, *others = map(np.array, seen["corners"])
    close(first, origin, "origin of VDB")
    close([p - first for p in others], np.eye(3) * spacing, "spacing of VDB")
    assert seen["active"] == (np.abs(values) < np.float32(band) * (1 - 1e-6)).sum() and seen["tiles_active"] == 0
    assert seen["metadata"]["unit"] == "mm" and seen["metadata"]["sign"] == "negative inside"
    check_surface(np.array(seen["points"]), np.array(seen["quads"]), values, origin, spacing)
    return values, origin, spacing, band


def check_surface(points, quads, values, origin, spacing):
    """The surface that OpenVDB makes of the level set is closed and lies where the values change sign."""
    import numpy as np

    edges = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], -1).reshape(-1, 2), axis=1)
    _, counts = np.unique(edges, axis=0, return_counts=True)
    assert len(quads) > 1000 and (counts % 2 == 0).all(), "the surface of the level set is open"
    cell = np.floor((points - origin) / spacing).astype(int)
    corners = [values[tuple((cell + [i, j, k]).T)] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    assert (np.min(corners, 0) <= 0).mean() > 0.99 and (np.max(corners, 0) >= 0).mean() > 0.99


def check_theirs(program, folder, values, origin, spacing, band):
    """We draw the same slice of their files as of ours."""
    import numpy as np

    ranges = {}

    def picture(path):
        out = folder / "slice.png"
        place = ["--slice", "z=50%", "--plain", "--width", "240", "--height", "200"]
        command = [program, "render", path, "-o", out, "-q", "--json", *place]
        report = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
        ranges[path.name] = report["result"]["slices"][0]["range"]
        return out.read_bytes()

    paths = list(vtk_write(values, origin, spacing, folder)) + list(nrrd_write(values, origin, spacing, folder))
    expected = picture(folder / "f.nrrd")
    # OpenVDB's files know whole blocks only, and NumPy's no places: the former show more, the latter have their own scale.
    vdb, half = folder / "theirs.vdb", folder / "half.vdb"
    np.save(folder / "values.npy", values)
    with_openvdb("write", folder / "values.npy", spacing, json.dumps(origin), band, vdb, half)
    for path in paths:
        assert picture(path) == expected, f"{path.name} is drawn otherwise"
    expected = picture(folder / "f.npy")
    for name, array in [("c", np.ascontiguousarray(values)), ("wide", values.astype(">f8"))]:
        path = folder / f"{name}.npy"
        np.save(path, array)
        assert picture(path) == expected, f"{path.name} is drawn otherwise"
    for path, tolerance in [(folder / "f.vdb", 1e-6), (vdb, 0.02), (half, 0.02)]:
        picture(path)
        assert np.allclose(ranges[path.name], ranges["f.nrrd"], atol=tolerance * band), ranges
    return len(paths) + 4


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--install", action="store_true")
    options = parser.parse_args()
    if options.install:
        install()
    program = options.program.resolve()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for name in ("vti", "nrrd", "npy", "vdb"):
            command = [program, "sdf", ROOT / "testdata" / "torus.ply", "-o", folder / f"f.{name}", "--resolution", "48"]
            command += ["--band", "3h", "--unit", "mm", "-q", "--report", folder / "report.json"]
            subprocess.run(command, check=True)
        report = json.loads((folder / "report.json").read_text())
        count = check_theirs(program, folder, *check_ours(folder, report))
    print(f"4 files of ours and {count} of theirs: all agree")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--openvdb"]:
        print(json.dumps({"read": openvdb_read, "write": openvdb_write}[sys.argv[2]](*sys.argv[3:])))
    else:
        main()
