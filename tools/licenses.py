#!/usr/bin/env python3
"""Gathers the licences of all crates that the program is built of into `src/cli/licenses.txt`, which `meshwright licenses` prints.

    tools/licenses.py           writes the file
    tools/licenses.py --check   fails where it is not what would be written

Each text stands there once, under the crates that it comes with. A crate without a text of its own is under the standard text of its licence. A licence
that is not in ALLOWED, or is not known at all, is an error.
"""

import collections
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FILE = ROOT / "src" / "cli" / "licenses.txt"

#: What may be linked into a program under MIT or Apache-2.0, the first of these where a crate gives the choice.
ALLOWED = ["MIT", "Apache-2.0", "BSD-3-Clause", "BSD-2-Clause", "ISC", "Zlib", "0BSD", "Unlicense", "BSL-1.0", "CC0-1.0", "Unicode-3.0", "IJG", "Apache-2.0 WITH LLVM-exception"]


#: What is in the program beside crates.
FONTS = [("Apache-2.0", "the font Roboto Regular (Google Inc.)")]


def packages() -> list[dict]:
    """The crates that a program with all features on Linux is built of, our own left out."""
    command = ["cargo", "metadata", "--format-version=1", "--locked", "--filter-platform=x86_64-unknown-linux-gnu"]
    told = json.loads(subprocess.run(command, cwd=ROOT, capture_output=True, check=True, text=True).stdout)
    nodes = {node["id"]: node for node in told["resolve"]["nodes"]}
    named = {package["id"]: package for package in told["packages"]}
    root = next(id for id, package in named.items() if package["name"] == "meshwright")
    found, waiting = set(), [root]
    while waiting:
        for dep in nodes[waiting.pop()]["deps"]:
            normal = any(kind["kind"] is None for kind in dep["dep_kinds"])
            if normal and dep["pkg"] not in found:
                found.add(dep["pkg"])
                waiting.append(dep["pkg"])
    found.discard(root)
    return sorted((named[id] for id in found), key=lambda package: (package["name"], package["version"]))


def choice(package: dict) -> list[str]:
    """The licences under which a crate is used: one, or several where all of them hold."""
    expression = (package["license"] or "").replace("/", " OR ")
    parts = [part.strip(" ()") for part in re.split(r"\bAND\b", expression)]
    chosen = []
    for part in parts:
        options = [one.strip(" ()") for one in re.split(r"\bOR\b", part)]
        allowed = [one for one in ALLOWED if one in options]
        if not allowed:
            sys.exit(f"{package['name']} {package['version']}: the licence {package['license']!r} is not allowed")
        chosen.append(allowed[0])
    return chosen


def texts(package: dict, licence: str) -> list[str]:
    """The texts of a licence that come with a crate."""
    folder = pathlib.Path(package["manifest_path"]).parent
    files = sorted(p for p in folder.iterdir() if p.is_file() and re.match(r"(?i)(licen[cs]e|copying|unlicense|notice)", p.name))
    word = licence.split("-")[0].split(" ")[0].lower()
    own = [p for p in files if word in p.name.lower()]
    general = [p for p in files if re.fullmatch(r"(?i)(licen[cs]e|copying)(\.\w+)?", p.name)]
    return [tidy(p.read_text(errors="replace")) for p in own or general]


def tidy(text: str) -> str:
    lines = [line.rstrip() for line in text.replace("\r\n", "\n").strip("\n").split("\n")]
    return "\n".join(lines)


def standard(licence: str) -> str:
    """The text of a licence without a holder of the copyright."""
    file = {"MIT": "LICENSE-MIT", "Apache-2.0": "LICENSE-APACHE"}.get(licence)
    if file is None:
        sys.exit(f"there is no standard text of {licence} here")
    lines = tidy((ROOT / file).read_text()).split("\n")
    return "\n".join(line for line in lines if not re.match(r"(?i)\s*copyright (\(c\) )?\d", line))


def made() -> str:
    together = collections.OrderedDict()
    without = collections.defaultdict(list)
    for package in packages():
        name = f"{package['name']} {package['version']}"
        for licence in choice(package):
            found = texts(package, licence)
            for text in found:
                together.setdefault((licence, text), []).append(name)
            if not found:
                without[licence].append(f"{name} ({', '.join(package['authors']) or package['repository'] or 'no author named'})")
    for licence, name in FONTS:
        without[licence].append(name)
    parts = ["meshwright is built of the crates below, and of one font. Each is used under the licence that is named above its text.\n"]
    for (licence, text), names in sorted(together.items(), key=lambda one: (one[0][0], one[1])):
        parts.append(f"{'=' * 80}\n{licence}: {', '.join(names)}\n{'=' * 80}\n{text}\n")
    for licence, names in sorted(without.items()):
        parts.append(f"{'=' * 80}\n{licence}, without a text of their own: {'; '.join(names)}\n{'=' * 80}\n{standard(licence)}\n")
    return "\n".join(parts)


def main() -> int:
    text = made()
    if "--check" in sys.argv:
        if not FILE.exists() or FILE.read_text() != text:
            print("src/cli/licenses.txt is not up to date: run tools/licenses.py", file=sys.stderr)
            return 1
        return 0
    FILE.write_text(text)
    print(f"{FILE.relative_to(ROOT)}: {len(text):,} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main())
