#!/usr/bin/env python3
"""Draws the README's pictures again, and pictures of two programs beside each other.

tools/pictures.py PROGRAM [--data FOLDER] [--before PROGRAM]

The pictures lie in docs/images. --data: the folder of real meshes, without which two of the pictures stay as they are. --before: also draws ten pictures with
this other program, and with PROGRAM, side by side into docs/images/look. The book's own pictures are drawn by tools/book.py.
"""

import argparse
import math
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
IMAGES = ROOT / "docs" / "images"
TEST = ROOT / "testdata"


def cube(path, low, high):
    corners = [[(high if k >> bit & 1 else low) for bit in range(3)] for k in range(8)]
    quads = [[0, 1, 5, 4], [0, 2, 3, 1], [4, 5, 7, 6], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    off(path, corners, [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])])


def cylinder(path, radius, low, high, sides, place):
    angles = [2 * math.pi * k / sides for k in range(sides)]
    ring = [[place[0] + radius * math.cos(a), place[1] + radius * math.sin(a)] for a in angles]
    corners = [p + [low] for p in ring] + [p + [high] for p in ring] + [list(place) + [low], list(place) + [high]]
    faces = []
    for k in range(sides):
        n = (k + 1) % sides
        faces += [[k, n, sides + n], [k, sides + n, sides + k], [2 * sides, n, k], [2 * sides + 1, sides + k, sides + n]]
    off(path, corners, faces)


def off(path, corners, faces):
    lines = ["OFF", f"{len(corners)} {len(faces)} 0"]
    lines += [" ".join(map(str, corner)) for corner in corners] + [f"3 {a} {b} {c}" for a, b, c in faces]
    Path(path).write_text("\n".join(lines) + "\n")


class Folder:
    """A program in a folder of its own."""

    def __init__(self, program, path):
        self.program, self.path = Path(program).resolve(), Path(path)

    def run(self, *words):
        words = [str(word) for word in words]
        done = subprocess.run([self.program, *words, "-q"], cwd=self.path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            sys.exit(f"meshwright {' '.join(words)}: exit status {done.returncode}\n{done.stderr}")

    def make(self, data):
        """The meshes that are drawn."""
        self.run("repair", TEST / "broken_mug.obj", "-o", "mug.stl", "--map", "mug_map.ply")
        self.run("canals", TEST / "bored_block.off", "-d", "2", "--map", "canals.ply")
        self.run("canals", TEST / "bored_block.off", "-d", "2", "--remove", "1,3", "-o", "filled.stl")
        self.run("thicken", TEST / "thin_parts.obj", "-o", "thick.stl", "--min", "0.8", "--map", "thick_map.ply")
        cube(self.path / "cube.off", 0, 10)
        cylinder(self.path / "cylinder.off", 3.2, 4, 13, 48, (7, 3))
        self.run("union", "cube.off", "cylinder.off", "-o", "union.stl")
        self.run("sdf", "mug.stl", "-o", "mug.vdb", "--resolution", "80")
        self.run("sdf", "mug.stl", "-o", "full.vdb", "--resolution", "80", "--band", "full")
        if data:
            self.run("repair", data / "clean" / "fandisk.off", "-o", "fandisk.stl", "--rebuild", "--force")
            self.run("repair", data / "broken" / "featuretype.STL", "-o", "part.stl")


def readme(folder, data):
    draw = lambda name, *words: folder.run("render", *words, "-o", IMAGES / f"{name}.png")
    draw("broken_mug", TEST / "broken_mug.obj", "mug.stl", "--width", 560, "--height", 480, "--unit", "mm")
    draw("union", "union.stl", "--edges", "all", "--width", 560, "--height", 420, "--title", "A cylinder united with a cube")
    draw("canals", "canals.ply", "filled.stl", "--width", 560, "--height", 330, "--title", "Canals narrower than 2", "--title", "Two of them filled")
    draw("thicken", TEST / "thin_parts.obj", "thick_map.ply", "--no-defects", "--width", 560, "--height", 430, "--title", "Before", "--title", "Walls of 0.8 at least")
    if data:
        draw("fandisk", data / "clean" / "fandisk.off", "fandisk.stl", "--width", 560, "--height", 420)
        draw("part", data / "broken" / "featuretype.STL", "part.stl", "--width", 560, "--height", 370)


def looks(folder, data):
    """Ten pictures: their names and the words after `render`."""
    pairs = [
        ("mug", [TEST / "broken_mug.obj", "mug.stl"]),
        ("map", ["mug_map.ply"]),
        ("canals", ["canals.ply"]),
        ("thick", ["thick.stl"]),
        ("union", ["union.stl", "--edges", "all"]),
        ("slice", ["mug.vdb", "--slice", "z=30%"]),
        ("gutter", ["full.vdb", "full.vdb"]),
        ("white", ["white.ply"]),
    ]
    if data:
        pairs += [("deviation", ["deviation.ply"]), ("bunny", [data / "broken" / "stanford-bunny.obj"])]
    return pairs


def white(path):
    """The repaired mug, painted white."""
    lines = [line.split() for line in (path / "mug.off").read_text().split("\n") if line and not line.startswith("#")]
    vertices, faces = int(lines[1][0]), int(lines[1][1])
    rows = [" ".join(row[:3]) + " 255 255 255" for row in lines[2 : 2 + vertices]]
    rows += [" ".join(row[:4]) for row in lines[2 + vertices : 2 + vertices + faces]]
    colours = "".join(f"property uchar {c}\n" for c in ("red", "green", "blue"))
    axes = "".join(f"property double {c}\n" for c in "xyz")
    head = f"ply\nformat ascii 1.0\nelement vertex {vertices}\n{axes}{colours}element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    (path / "white.ply").write_text(head + "\n".join(rows) + "\n")


def beside(before, after, data):
    import PIL.Image

    look = IMAGES / "look"
    look.mkdir(exist_ok=True)
    after.run("convert", "mug.stl", "-o", "mug.off")
    white(after.path)
    if data:
        bunny = data / "broken" / "stanford-bunny.obj"
        after.run("repair", bunny, "-o", "bunny.stl", "--keep-partial")
        after.run("decimate", "bunny.stl", "-o", "few.stl", "--triangles", "6000")
        for folder, name in ((before, "deviation_before.ply"), (after, "deviation.ply")):
            Folder(folder.program, after.path).run("compare", "bunny.stl", "few.stl", "--map", name)
    for name, words in looks(after, data):
        images = []
        for folder in (before, after):
            out = after.path / f"{name}_{len(images)}.png"
            own = [f"{name}_before.ply" if folder is before and word == "deviation.ply" else word for word in words]
            Folder(folder.program, after.path).run("render", *own, "-o", out)
            images.append(PIL.Image.open(out).convert("RGB"))
        size = (600, round(600 * images[0].height / images[0].width))
        sheet = PIL.Image.new("RGB", (2 * size[0] + 12, size[1]), "black")
        for n, image in enumerate(images):
            sheet.paste(image.resize(size, PIL.Image.LANCZOS), (n * (size[0] + 12), 0))
        sheet.save(look / f"{name}.jpg", quality=82)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--data", type=Path)
    parser.add_argument("--before")
    args = parser.parse_args()
    data = args.data.resolve() if args.data else None
    with tempfile.TemporaryDirectory() as scratch:
        folder = Folder(args.program, scratch)
        folder.make(data)
        readme(folder, data)
        if args.before:
            beside(Folder(args.before, scratch), folder, data)


if __name__ == "__main__":
    main()
