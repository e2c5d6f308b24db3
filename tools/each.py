#!/usr/bin/env python3
"""Compares the objects of a file with those of what `meshwright repair --each` has made of it, by other programs' readers.

    python3 tools/each.py PROGRAM IN.glb OUT.glb [--flags ...]      runs the program first
    python3 tools/each.py - IN.3mf OUT.3mf                          compares what is there

trimesh reads all of 3MF, glTF and OBJ (pip install trimesh networkx lxml); lib3mf reads 3MF as slicers do (pip install lib3mf) and is left
out where it is not installed. Compared are names, places (the transforms of instances), materials and colours, and the box around all;
of the result each object must be closed, with one winding and a volume above zero. Exit status 1 where something differs.
"""

import json
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import trimesh

try:
    import lib3mf
except ImportError:
    lib3mf = None

WRONG = []


def check(condition, what):
    print(("ok     " if condition else "WRONG  ") + what)
    if not condition:
        WRONG.append(what)


def scene_of(path):
    """The scene as trimesh has it, and for each node with a mesh: its name, mesh and transform."""
    scene = trimesh.load(path, force="scene", process=False)
    nodes = []
    for name in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[name]
        nodes.append((name, geometry, np.asarray(transform)))
    return scene, sorted(nodes, key=lambda node: (node[1], node[0]))


def document(path):
    """The JSON of a glTF file; trimesh gives nodes without a name one by chance."""
    data = Path(path).read_bytes()
    return json.loads(data[20 : 20 + struct.unpack("<I", data[12:16])[0]] if data[:4] == b"glTF" else data)


def alike(a, b):
    """Whether two values of JSON are the same, numbers to the last digit but one."""
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(alike(a[key], b[key]) for key in a)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(alike, a, b))
    if isinstance(a, float) or isinstance(b, float):
        return abs(a - b) <= 1e-15 * abs(a)
    return a == b


def blocks_of(path):
    """The meshes under the `o` lines of an OBJ file; trimesh parts and joins them by material."""
    places, blocks = [], {}
    name = ""
    for line in Path(path).read_text().splitlines():
        kind, _, rest = line.partition(" ")
        if kind == "v":
            places.append([float(word) for word in rest.split()[:3]])
        elif kind == "o":
            name = f"{len(blocks) + 1} {rest}"
        elif kind == "f":
            blocks.setdefault(name, []).append([int(word.split("/")[0]) - 1 for word in rest.split()])
    return {name: trimesh.Trimesh(places, faces, process=False) for name, faces in blocks.items()}


def look(mesh):
    """The colour or the material of a mesh, in a few words."""
    visual = mesh.visual
    if visual.kind == "texture":
        material = visual.material
        return ("material", material.name, str(getattr(material, "baseColorFactor", getattr(material, "diffuse", None))))
    if visual.kind in ("face", "vertex"):
        colours = visual.face_colors if visual.kind == "face" else visual.vertex_colors
        found, counts = np.unique(colours, axis=0, return_counts=True)
        return ("colour", tuple(found[counts.argmax()].tolist()))
    return ("none",)


def by_trimesh(before, after):
    same = Path(before).suffix.lower() == Path(after).suffix.lower()
    (a, old), (b, new) = scene_of(before), scene_of(after)
    print(f"trimesh: {len(a.geometry)} meshes at {len(old)} nodes before, {len(b.geometry)} at {len(new)} after")
    if same:
        if Path(before).suffix.lower() in (".glb", ".gltf"):
            old_json, new_json = document(before), document(after)
            for kind in ("nodes", "materials", "scenes", "cameras", "skins"):
                check(alike(old_json.get(kind), new_json.get(kind)), f"{kind} as the document has them")
        else:
            check(sorted(n[0] for n in old) == sorted(n[0] for n in new), "the names of nodes")
        check(len(old) == len(new), "the number of instances")
        check(all(np.allclose(x[2], y[2], atol=1e-6) for x, y in zip(old, new)), "the transforms of all instances")
        for name in a.geometry:
            if name in b.geometry:
                check(look(a.geometry[name]) == look(b.geometry[name]), f"the look of {name}: {look(b.geometry[name])}")
    scale = trimesh.units.unit_conversion(a.units or "mm", b.units or "mm") if a.units and b.units else 1.0
    size = np.abs(b.bounds).max()
    (low, high), (least, most) = a.bounds * scale, b.bounds
    near = 1e-4 * size
    if same:
        check(np.allclose([low, high], [least, most], atol=near), f"the box around all: {b.bounds.round(4).tolist()}")
    else:
        # Supports and the like are left out of files of another kind.
        within = (least >= low - near).all() and (most <= high + near).all()
        check(within, f"the box around all is within that of before: {b.bounds.round(4).tolist()}")
    # A mesh of several materials is several meshes to trimesh; whole objects are looked at.
    objects = blocks_of(after) if Path(after).suffix.lower() == ".obj" else whole_objects(b)
    for name, mesh in objects.items():
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        mesh.remove_unreferenced_vertices()
        kinds = (mesh.is_watertight, mesh.is_winding_consistent, mesh.volume > 0)
        check(all(kinds), f"{name}: closed, one winding, volume {mesh.volume:.6g} ({len(mesh.faces)} triangles)")


def whole_objects(scene):
    """Meshes that a reader has parted by material, put together under the name of their node's parent."""
    groups = {}
    for node in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[node]
        parent = scene.graph.transforms.parents.get(node, node)
        key = (parent, node) if parent in ("world", None) else (parent, "")
        groups.setdefault(key, []).append((geometry, np.asarray(transform)))
    objects = {}
    for (parent, node), pieces in groups.items():
        meshes = [trimesh.Trimesh(scene.geometry[g].vertices, scene.geometry[g].faces, process=False).apply_transform(t)
                  for g, t in pieces]
        objects[f"{node or parent} ({', '.join(sorted({g for g, _ in pieces}))})"] = trimesh.util.concatenate(meshes)
    return objects


def colour_of(model, mesh):
    """The colour, or the base material, that most triangles have."""
    found = {}
    for t in range(mesh.GetTriangleCount()):
        properties = mesh.GetTriangleProperties(t)
        key = (properties.ResourceID, properties.PropertyIDs[0])
        found[key] = found.get(key, 0) + 1
    resource, entry = max(found, key=found.get, default=(0, 0))
    if not resource:
        return None
    kind = model.GetPropertyTypeByID(resource)
    if kind == lib3mf.PropertyType.Colors:
        colour = model.GetColorGroupByID(resource).GetColor(entry)
    elif kind == lib3mf.PropertyType.BaseMaterial:
        group = model.GetBaseMaterialGroupByID(resource)
        return group.GetName(entry)
    else:
        return str(kind)
    return (colour.Red, colour.Green, colour.Blue, colour.Alpha)


def items_of(path):
    """The objects and the build of a 3MF file as lib3mf has them."""
    wrapper = lib3mf.get_wrapper()
    model = wrapper.CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(False)
    reader.ReadFromFile(str(path))
    warnings = [reader.GetWarning(n)[1] for n in range(reader.GetWarningCount())]

    def numbers(transform):
        return [round(float(x), 5) for column in transform.Fields for x in column]

    objects, iterator = {}, model.GetObjects()
    while iterator.MoveNext():
        found = iterator.GetCurrentObject()
        about = {"name": found.GetName(), "type": str(found.GetType())}
        if found.IsMeshObject():
            mesh = model.GetMeshObjectByID(found.GetResourceID())
            about["closed"] = mesh.IsManifoldAndOriented()
            about["colour"] = colour_of(model, mesh)
        else:
            parts = model.GetComponentsObjectByID(found.GetResourceID())
            components = [parts.GetComponent(n) for n in range(parts.GetComponentCount())]
            about["components"] = [(c.GetObjectResourceID(), numbers(c.GetTransform())) for c in components]
        objects[found.GetResourceID()] = about
    build, iterator = [], model.GetBuildItems()
    while iterator.MoveNext():
        item = iterator.GetCurrent()
        build.append((item.GetObjectResourceID(), item.GetPartNumber(), numbers(item.GetObjectTransform())))
    return objects, build, str(model.GetUnit()), warnings


def by_lib3mf(before, after):
    objects, build, unit, warnings = items_of(after)
    print(f"lib3mf: {len(objects)} objects, {len(build)} items of the build, in {unit}")
    check(not warnings, f"no warnings {warnings}")
    for number, about in objects.items():
        if "closed" in about:
            check(about["closed"], f"object {number} {about['name']!r}: manifold and oriented, {about['type']}")
    if Path(before).suffix.lower() == ".3mf":
        old = items_of(before)
        without = lambda all: {n: {k: v for k, v in o.items() if k != "closed"} for n, o in all.items()}
        names = lambda all: [(o["name"], o["type"]) for o in all.values()]
        check(names(old[0]) == names(objects), "names and types of objects")
        colours = lambda all: [o["colour"] for o in all.values() if "colour" in o]
        check(colours(old[0]) == colours(objects), f"colours and materials: {colours(objects)}")
        # lib3mf counts resources anew; what is before an object may be one group more.
        shape = lambda all: [[t for _, t in o.get("components", [])] for o in without(all).values()]
        check(shape(old[0]) == shape(objects), "components and their transforms")
        check([item[1:] for item in old[1]] == [item[1:] for item in build], "items of the build: part numbers, transforms")
        check(old[2] == unit, "the unit")


def main():
    program, before, after, *flags = sys.argv[1:] if len(sys.argv) > 3 else sys.exit(__doc__)
    if program != "-":
        done = subprocess.run([program, "repair", before, "--each", "-o", after, "--force", *flags])
        check(done.returncode in (0, 3), f"exit status {done.returncode}")
    by_trimesh(before, after)
    if lib3mf and Path(after).suffix.lower() == ".3mf":
        by_lib3mf(before, after)
    print(f"{len(WRONG)} wrong")
    sys.exit(1 if WRONG else 0)


if __name__ == "__main__":
    main()
