"""Makes `python/meshwright/verbs.py`: one function for each verb of the command line, with its flags as keywords, from the program's own list of them.

    python tools/python_verbs.py           writes the file
    python tools/python_verbs.py --check   fails where the file is not what would be written

The module must be installed, because it is asked for the flags.
"""

from __future__ import annotations

import sys
import textwrap
from pathlib import Path

from meshwright import _native

#: Flags about files and streams, which functions have no use for, and those that every function has by itself.
LEFT_OUT = {
    *("output", "report", "json", "quiet", "verbose", "force", "ascii", "plan", "threads"),
    # The numbers of a lattice have no choice of format.
    "sdf:out-format",
    "convert:in-format",
    # Its result is a file of objects, not a mesh.
    "repair:each",
    # An animation is a file; views are turned one by one.
    "render:turntable",
}

LENGTH = ("LEN", "LEN|off", "LEN|full", "VOLUME", "LEN|PLANE", "AXIS[=AT]")
NUMBERS = {"N": "int", "PIXELS": "int", "DEG": "float", "R": "float", "SHARE": "str | float", "LIMIT": "float", "SIZE": "str | int", "DUR": "str | float"}
LISTS = {"all|N,N": "str | Sequence[int]", "D@X,Y,Z": "str | Sequence[str]", "X,Y,Z": "str | Sequence[float]"}
LISTS |= {"FROM,TO": "str | Sequence[int]", "LOW,HIGH": "str | Sequence[float]", "DEFECT": "str | Sequence[str]", "F|X,Y,Z": "str | float | Sequence[float]"}

#: For each verb: its parameters before the keywords, what it is called with, the format of its result, what it returns, and its documentation.
ONE = ("mesh: MeshLike", "[mesh]")
MANY = ("*meshes: MeshLike | Sequence[MeshLike]", "several(meshes)")
NAMED = ("expression: str, meshes: Mapping[str, MeshLike]", "meshes")

VERBS: dict[str, tuple[tuple[str, str], str | None, str, str]] = {}


def verb(name: str, given: tuple[str, str], result: str | None, returns: str, text: str) -> None:
    VERBS[name] = (given, result, returns, textwrap.dedent(text).strip())


verb("repair", ONE, "ply", "Mesh", """
    Makes one closed, oriented solid surface of a broken mesh. What is right in it stays exactly as it is; ``.sources`` and ``.kinds`` of the result
    say for each triangle where it comes from.

    >>> import meshwright as mw
    >>> mug = mw.repair("testdata/broken_mug.obj", resolution=64)
    >>> mug.validity["open_edges"]
    0
""")
verb("union", MANY, "ply", "Mesh", """
    Everything inside at least one of the meshes, each of which may be broken. Meshes are given one by one, or as one list.

    >>> import meshwright as mw
    >>> mug = mw.read("testdata/broken_mug.obj")
    >>> both = mw.union(mug, "testdata/hollow_ball.stl", resolution=64)
    >>> sorted(set(both.sources[:, 0].tolist()) - {-1})
    [0, 1]
""")
verb("intersection", MANY, "ply", "Mesh", """
    Everything inside all of the meshes, each of which may be broken.

    >>> import meshwright as mw
    >>> mw.intersection("testdata/hollow_ball.stl", "testdata/hollow_ball.stl", resolution=64).validity["open_edges"]
    0
""")
verb("difference", MANY, "ply", "Mesh", """
    The first mesh without all the others; each may be broken.

    >>> import meshwright as mw
    >>> try:
    ...     mw.difference("testdata/hollow_ball.stl", "testdata/hollow_ball.stl", resolution=64)
    ... except mw.NothingEnclosed as error:
    ...     print(error.reason)
    no-common-part
""")
verb("csg", NAMED, "ply", "Mesh", """
    Any boolean expression over named meshes, such as ``"a - (b | c) & d"``.

    >>> import meshwright as mw
    >>> ball = mw.read("testdata/hollow_ball.stl")
    >>> mw.csg("a | b", {"a": ball, "b": "testdata/broken_mug.obj"}, resolution=64).validity["open_edges"]
    0
""")
verb("dilate", ONE, "ply", "Mesh", """
    Grows a solid by ``radius`` on all sides; a broken mesh is repaired first.

    >>> import meshwright as mw
    >>> ball = mw.repair("testdata/hollow_ball.stl", resolution=64)
    >>> mw.dilate(ball, radius="2%", resolution=64).volume > ball.volume
    True
""")
verb("erode", ONE, "ply", "Mesh", """
    Shrinks a solid by ``radius`` on all sides; a broken mesh is repaired first.

    >>> import meshwright as mw
    >>> ball = mw.repair("testdata/hollow_ball.stl", resolution=64)
    >>> mw.erode(ball, radius="1%", resolution=64).volume < ball.volume
    True
""")
verb("open", ONE, "ply", "Mesh", """
    Takes away what a ball of ``radius`` inside cannot reach: whiskers, fins, thin walls.

    >>> import meshwright as mw
    >>> mw.open("testdata/broken_mug.obj", radius="1%", resolution=64).validity["open_edges"]
    0
""")
verb("close", ONE, "ply", "Mesh", """
    Fills what a ball of ``radius`` outside cannot reach: cracks, canals, narrow gaps.

    >>> import meshwright as mw
    >>> mw.close("testdata/broken_mug.obj", radius="1%", resolution=64).validity["open_edges"]
    0
""")
verb("canals", ONE, "ply", "tuple[list[dict[str, Any]], Mesh | None]", """
    Lists canals, pits and gaps that a closing would fill, and fills those that ``remove`` names. Returns the list, one dictionary each as in the
    report, and the mesh with these filled, or ``None`` without ``remove``.

    >>> import meshwright as mw
    >>> found, mesh = mw.canals("testdata/broken_mug.obj", max_diameter="5%", resolution=64)
    >>> mesh is None
    True
""")
verb("thicken", ONE, "ply", "Mesh", """
    Lets walls that are too thin, and open sheets, grow to a thickness; with ``base`` makes a block of an open sheet.

    >>> import meshwright as mw
    >>> sheet = ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> bool(abs(mw.thicken(sheet, base=0.5).volume - 0.5) < 1e-9)
    True
""")
verb("hollow", ONE, "ply", "Mesh", """
    Shells a solid out: a cavity in it, walls of one thickness, and holes to drain it.

    >>> import meshwright as mw
    >>> ball = mw.dilate("testdata/hollow_ball.stl", radius="5%", resolution=64)
    >>> mw.hollow(ball, wall="5%", resolution=64).volume < ball.volume
    True
""")
verb("decimate", ONE, "ply", "Mesh", """
    Leaves fewer triangles of a valid solid: a number, a share, or as many as the surface may move.

    >>> import meshwright as mw
    >>> ball = mw.repair("testdata/hollow_ball.stl", resolution=64)
    >>> len(mw.decimate(ball, ratio=0.5).faces) <= len(ball.faces) / 2
    True
""")
verb("sdf", ONE, "nrrd", "Grid", """
    The signed distance to a mesh over a lattice, negative inside. At points of your own: :func:`meshwright.signed_distance`.

    >>> import meshwright as mw
    >>> grid = mw.sdf("testdata/hollow_ball.stl", resolution=32, band="full")
    >>> grid.values.dtype, grid.values.ndim
    (dtype('float32'), 3)
""")
verb("field", NAMED, None, "Mesh", """
    Combines, filters and morphs shapes through their distance fields, by an expression in the language of ``docs/field.md``.

    >>> import meshwright as mw
    >>> mw.field("offset(a, 2%)", {"a": "testdata/hollow_ball.stl"}, resolution=64).validity["open_edges"]
    0
""")
verb("inspect", ONE, None, "dict[str, Any]", """
    Says what is in a mesh and what is wrong with it: the report as ``--json`` prints it.

    >>> import meshwright as mw
    >>> report = mw.inspect("testdata/broken_mug.obj")
    >>> report["inputs"][0]["validity"]["open_edges"] > 0
    True
""")
verb("compare", ("a: MeshLike, b: MeshLike", "[a, b]"), None, "dict[str, Any]", """
    Measures how far two meshes are from each other, model units; the second is judged by the first.

    >>> import meshwright as mw
    >>> mw.compare("testdata/hollow_ball.stl", "testdata/hollow_ball.stl")["symmetric"]["max"]
    0.0
""")
verb("render", ("mesh: MeshLike, after: MeshLike | None = None", "[mesh] if after is None else [mesh, after]"), "png", "NDArray[np.uint8]", """
    Draws a mesh, or two of them beside each other: red, green, blue and alpha of each pixel, shape (height, width, 4).

    >>> import meshwright as mw
    >>> mw.render("testdata/broken_mug.obj", width=64, height=48).shape
    (48, 64, 4)
""")


def annotation(flag: dict) -> str:
    value, choices = flag["value"], flag["choices"]
    if value is None:
        return "bool"
    if choices and not flag["several"]:
        kind = "Literal[" + ", ".join(f'"{choice}"' for choice in choices) + "]"
    elif value in LENGTH:
        kind = "Length"
    else:
        kind = NUMBERS.get(value) or LISTS.get(value, "str")
    if flag["several"] and "Sequence" not in kind:
        kind = f"{kind} | Sequence[{kind}]"
    return kind


def keyword(name: str) -> str:
    return name.replace("-", "_")


def parameters(verb: str) -> list[dict]:
    flags = _native.flags(verb)
    assert flags is not None, verb
    return [flag for flag in flags if flag["name"] not in LEFT_OUT and f"{verb}:{flag['name']}" not in LEFT_OUT]


def takes_a_bare_flag(flag: dict) -> bool:
    return flag["optional_value"]


def function(name: str) -> str:
    (given, positional), result, returns, text = VERBS[name]
    flags = parameters(name)
    flags.sort(key=lambda flag: not flag["required"])
    lines = [f"def {name}(", *(f"    {one.strip()}," for one in given.split(", ")) ]
    if not given.startswith("*"):
        lines.append("    *,")
    if name == "field":
        flags.insert(0, {"name": "grid", "value": None, "required": False, "default": None, "choices": [], "several": False,
                         "optional_value": False, "help": "Return the values over a lattice, a :class:`Grid`, instead of the surface"})
    for flag in flags:
        kind = annotation(flag)
        if flag["value"] is None:
            lines.append(f"    {keyword(flag['name'])}: bool = False,")
        elif flag["required"]:
            lines.append(f"    {keyword(flag['name'])}: {kind},")
        else:
            kind = f"bool | {kind}" if takes_a_bare_flag(flag) else kind
            lines.append(f"    {keyword(flag['name'])}: {kind} | None = None,")
    lines += ["    threads: int | None = None,", "    progress: Progress = False,"]
    returned = {"field": "Mesh | Grid | list[Any]"}.get(name, returns)
    lines.append(f") -> {returned}:")
    lines += docstring(text, flags)
    options = ", ".join(f'"{keyword(flag["name"])}": {keyword(flag["name"])}' for flag in flags if flag["name"] != "grid")
    lines.append(f"    options: dict[str, Any] = {{{options}}}")
    lines += body(name, positional, result)
    return "\n".join(lines)


def docstring(text: str, flags: list[dict]) -> list[str]:
    paragraphs, _, example = text.partition("\n\n>>>")
    lines = textwrap.indent('"""' + paragraphs, "    ").splitlines()
    lines += ["", "    Keywords, as on the command line:", ""]
    for flag in flags:
        default = f" (default: {flag['default']})" if flag["default"] not in (None, "false") else ""
        help = flag["help"].replace("\\", "\\\\").replace("--", "").replace("`", "``").rstrip(".")
        entry = f"``{keyword(flag['name'])}``: {help}{default}."
        lines += textwrap.wrap(entry, 150, initial_indent="    - ", subsequent_indent="      ", break_long_words=False)
    lines += ["    - ``threads``: Threads to use; without it those that all calls share, one for each core.",
              "    - ``progress``: ``True`` for a bar, or a function that is told the stage and its share, 0 to 1."]
    if example:
        lines += ["", *textwrap.indent(">>>" + example, "    ").splitlines()]
    return [*lines, '    """']


def body(name: str, positional: str, result: str | None) -> list[str]:
    also = "expression=expression, " if VERBS[name][0] is NAMED else ""
    if name == "field":
        return [
            '    result = "nrrd" if grid else str(out_format or "ply")',
            f'    made, _ = call("field", {positional}, options, {also}result=result, threads=threads, progress=progress)',
            "    return made if frames is not None else cast(Mesh, made[0])",
        ]
    run = f'call("{name}", {positional}, options, {also}result={{}}, threads=threads, progress=progress)'
    if name in ("inspect", "compare"):
        what = 'report' if name == "inspect" else 'cast("dict[str, Any]", report["result"]["comparison"])'
        return [f"    _, report = {run.format(None)}", f"    return {what}"]
    if name == "canals":
        result_of = "None if remove is None or remove is False else str(out_format or \"ply\")"
        return [
            f"    made, report = {run.format(result_of)}",
            '    found = report["result"]["pipeline"]["canals"]["canals"]',
            "    return found, made[0] if made else None",
        ]
    has_format = any(flag["name"] == "out-format" for flag in parameters(name))
    wanted = f'str(out_format or "{result}")' if has_format else f'"{result}"'
    kind = {"Mesh": "Mesh", "Grid": "Grid"}.get(VERBS[name][2], '"NDArray[np.uint8]"')
    return [f"    made, _ = {run.format(wanted)}", f"    return cast({kind}, made[0])"]


HEAD = '''"""One function for each verb of the command line. This file is made by `tools/python_verbs.py`; do not edit it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import NDArray

from ._call import Progress, call
from ._given import Length, MeshLike, several
from ._made import Grid, Mesh

__all__ = [
'''


def text() -> str:
    names = "".join(f'    "{name}",\n' for name in sorted(VERBS))
    return HEAD + names + "]\n\n\n" + "\n\n\n".join(function(name) for name in VERBS) + "\n"


def main() -> int:
    path = Path(__file__).parents[1] / "python" / "meshwright" / "verbs.py"
    made = text()
    if "--check" in sys.argv:
        if path.read_text() != made:
            print("python/meshwright/verbs.py is not what tools/python_verbs.py makes: run it", file=sys.stderr)
            return 1
        return 0
    path.write_text(made)
    return 0


if __name__ == "__main__":
    sys.exit(main())
