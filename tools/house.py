#!/usr/bin/env python3
"""Checks the rules of the house that can be read from the source (docs/architecture.md).

    python3 tools/house.py           what breaks a rule; exit status 1 if anything does
    python3 tools/house.py --order   also the folders of src/, lowest stage first

No circle of imports between files, nor between the folders of src/; no file over 500 lines; at most one function in a hundred over 60 lines.

An import is a path in a `use` line or in the code; it leads to the file that defines the name, through re-exports. That a file declares its
modules and re-exports their names is no import, and what a file takes from the `mod.rs` of its own folder, or of one around it, is the common
ground of the folder and makes no circle. Code of tests is not looked at.
"""

import argparse
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCE = ROOT / "src"
LONG_FILE, LONG_FUNCTION, SHARE = 500, 60, 0.01

BLANKED = re.compile(
    r"""//[^\n]*|/\*.*?\*/|b?r(\#*)".*?"\1|b?"(?:\\.|[^"\\])*"|b?'(?:\\(?:x..|u\{[^}]*\}|.)|[^'\\\n])'""", re.S
)
TEST = re.compile(r"#\[cfg\(test\)\]\s*(?:pub(?:\([^)]*\))?\s+)?(?:mod|use|fn|impl)\b")
PATH = re.compile(r"(?<![\w:])(\w+(?:::\w+)+|crate|super)")


def blanked(text):
    """The text with comments, strings and characters made blank; lines and places stay."""
    return BLANKED.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)


def block_end(text, start):
    """Where the block or statement ends that starts at `start`."""
    depth = 0
    for place in range(start, len(text)):
        if text[place] == "{":
            depth += 1
        elif text[place] == "}":
            depth -= 1
            if depth == 0:
                return place + 1
        elif text[place] == ";" and depth == 0:
            return place + 1
    return len(text)


def without_tests(text):
    """Blanks what is compiled for tests only."""
    while found := TEST.search(text):
        end = block_end(text, found.end())
        text = text[: found.start()] + re.sub(r"[^\n]", " ", text[found.start() : end]) + text[end:]
    return text


def leaves(tree, before=()):
    """The paths of a `use` tree, each with the name that it binds; `*` binds all."""
    tree = tree.strip()
    depth, parts, start = 0, [], 0
    for place, letter in enumerate(tree):
        depth += (letter == "{") - (letter == "}")
        if letter == "," and depth == 0:
            parts.append(tree[start:place])
            start = place + 1
    parts.append(tree[start:])
    for part in filter(None, (part.strip() for part in parts)):
        if "{" in part:
            head, rest = part.split("{", 1)
            yield from leaves(rest.rsplit("}", 1)[0], before + tuple(filter(None, head.strip().split("::"))))
            continue
        path, _, name = part.partition(" as ")
        path = before + tuple(word.strip() for word in path.strip().split("::") if word.strip())
        if path[-1] == "self":
            path = path[:-1]
        yield path, (name.strip() or path[-1])


class Module:
    """A file, with the modules that it declares and the names that it imports."""

    def __init__(self, path, name, parent):
        self.path, self.name, self.parent = path, name, parent
        self.children, self.names, self.globs, self.exported = {}, {}, [], set()
        self.lines = path.read_text().count("\n")
        self.text = without_tests(blanked(path.read_text()))
        folder = path.parent if path.name in ("mod.rs", "lib.rs", "main.rs") else path.with_suffix("")
        for found in re.finditer(r"\bmod\s+(\w+)\s*;", self.text):
            place = next((p for p in (folder / f"{found[1]}.rs", folder / found[1] / "mod.rs") if p.exists()), None)
            if place:
                self.children[found[1]] = Module(place, found[1], self)
        inner = re.finditer(r"\bmod\s+\w+\s*(?=\{)", self.text)
        self.inner = [(found.start(), block_end(self.text, found.end())) for found in inner]
        self.uses = []
        for found in re.finditer(r"((?:pub(?:\([^)]*\))?\s+)?)use\s+([^;]+);", self.text):
            for path, name in leaves(found[2]):
                self.uses.append((path, name, bool(found[1]), self.depth(found.start())))
        for path, name, exported, depth in self.uses:
            if name == "*":
                self.globs.append((path, depth))
            else:
                self.names.setdefault(name, (path, depth))
                if exported:
                    self.exported.add(name)

    def depth(self, place):
        """In how many modules within this file a place lies."""
        return sum(start < place < end for start, end in self.inner)

    def all(self):
        yield self
        for child in self.children.values():
            yield from child.all()

    def root(self):
        return self.parent.root() if self.parent else self

    def start(self, path, depth):
        """The module at which a path starts, and what is left of it; None for other crates and for names of this file."""
        module = self
        if path[0] == "crate":
            return self.root(), path[1:]
        if path[0] in ("self", "super"):
            for word in path:
                if word == "super":
                    if depth > 0:
                        depth -= 1
                    else:
                        module = module.parent
                elif word != "self":
                    break
                path = path[1:]
            return module, path
        if path[0] in self.children or path[0] in self.names:
            return self, path
        return None

    def resolve(self, path, depth=0, seen=frozenset()):
        """The file that defines what a path names."""
        begun = self.start(path, depth)
        if begun is None or begun[0] is None:
            return None
        module, path = begun
        return module.inside(path, seen)

    def inside(self, path, seen):
        if not path or (self.path, path) in seen:
            return self
        seen = seen | {(self.path, path)}
        if path[0] in self.children:
            return self.children[path[0]].inside(path[1:], seen)
        if path[0] in self.names:
            target, depth = self.names[path[0]]
            if target[0] != path[0] or len(target) > 1:
                return self.resolve(target + path[1:], depth, seen)
        return self

    def imports(self):
        """The files that this one takes something from, each with the first path that leads there."""
        bound = {}
        for path, name, exported, depth in self.uses:
            target = self.resolve(path, depth)
            if target is None or exported and target.is_below(self):
                continue
            is_module = target is not self and name == target.name and path[-1] == target.name
            if not is_module:
                bound.setdefault(target, "::".join(path))
        # Paths in the code; a `use` line has been looked at already.
        code = re.sub(r"\buse\s+[^;]+;", lambda found: " " * len(found[0]), self.text)
        for found in PATH.finditer(code):
            path = tuple(found[1].split("::"))
            if len(path) > 1 and (target := self.resolve(path, self.depth(found.start()))):
                bound.setdefault(target, found[1])
        return {target: path for target, path in bound.items() if not self.is_below(target)}

    def is_below(self, other):
        return self is other or self.parent is not None and self.parent.is_below(other)

    def label(self):
        return str(self.path.relative_to(ROOT))


def circles(graph):
    """Sets of more than one node each of which leads to each other one (Tarjan's algorithm)."""
    index, low, stack, on, found = {}, {}, [], set(), []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        on.add(node)
        for after in graph[node]:
            if after not in index:
                visit(after)
                low[node] = min(low[node], low[after])
            elif after in on:
                low[node] = min(low[node], index[after])
        if low[node] == index[node]:
            circle = []
            while True:
                circle.append(stack.pop())
                on.discard(circle[-1])
                if circle[-1] == node:
                    break
            found.append(circle)

    sys.setrecursionlimit(10_000)
    for node in graph:
        if node not in index:
            visit(node)
    return found


def shortest(graph, circle):
    """The shortest way around through one of the nodes, as a list that ends where it begins."""
    best = None
    for start in circle:
        before, border = {start: None}, [start]
        while border:
            node = border.pop(0)
            if start in graph[node]:
                way = [start]
                while node is not None:
                    way.append(node)
                    node = before[node]
                best = min(best or way, way, key=len)
                break
            for after in graph[node]:
                if after in circle and after not in before:
                    before[after] = node
                    border.append(after)
    return list(reversed(best))


def functions(module):
    """Name, line and length of each function."""
    for found in re.finditer(r"\bfn\s+(\w+)", module.text):
        end = block_end(module.text, found.end())
        yield found[1], module.text.count("\n", 0, found.start()) + 1, module.text.count("\n", found.start(), end) + 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--order", action="store_true", help="print the folders of src/, lowest stage first")
    arguments = parser.parse_args()
    modules = list(Module(SOURCE / "lib.rs", "crate", None).all())
    by_path = {module.path: module for module in modules}
    root = by_path[SOURCE / "lib.rs"]
    taken = {module: module.imports() for module in modules if module is not root}
    graph = {module: sorted(targets, key=Module.label) for module, targets in taken.items()}
    faults = []

    for circle in circles(graph):
        if len(circle) > 1:
            faults.append(f"circle of {len(circle)} files:")
            way = shortest(graph, set(circle))
            faults.extend(f"  {a.label()} takes {taken[a][b]} from {b.label()}" for a, b in zip(way, way[1:]))

    top = lambda module: module if module.parent is root else top(module.parent)  # noqa: E731
    folders = {module: [] for module in root.children.values()}
    for module, targets in graph.items():
        for target in targets:
            if top(target) is not top(module) and top(target) not in folders[top(module)]:
                folders[top(module)].append(top(target))
    order = circles(folders)
    for circle in order:
        if len(circle) > 1:
            way = " -> ".join(module.name for module in shortest(folders, set(circle)))
            faults.append(f"circle of folders: {way}")
    if arguments.order:
        print(" ".join(module.name for circle in order for module in circle))

    for module in modules:
        if module.lines > LONG_FILE:
            faults.append(f"{module.label()} has {module.lines} lines, more than {LONG_FILE}")
    every = [(module, *function) for module in modules for function in functions(module)]
    long = [entry for entry in every if entry[3] > LONG_FUNCTION]
    if len(long) > SHARE * len(every):
        faults.append(f"{len(long)} of {len(every)} functions are longer than {LONG_FUNCTION} lines:")
        faults.extend(f"  {m.label()}:{line} {name}: {length}" for m, name, line, length in sorted(long, key=lambda e: -e[3]))

    lost = sorted(p for p in SOURCE.rglob("*.rs") if p not in by_path and not is_test_or_program(p, by_path))
    faults.extend(f"{p.relative_to(ROOT)} is declared by no module" for p in lost)

    for fault in faults:
        print(fault)
    print(f"{len(modules)} files, {len(every)} functions, {len(long)} of them over {LONG_FUNCTION} lines")
    return 1 if faults else 0


def is_test_or_program(path, by_path):
    """Whether a file is the program's, or belongs to the tests of a module."""
    if path == SOURCE / "main.rs":
        return True
    owners = [path.parent / "mod.rs", path.parent.with_suffix(".rs"), path.parent / "lib.rs", path.parent.parent / "mod.rs"]
    names = {path.stem, path.parent.name}
    return any(
        owner in by_path and re.search(rf"#\[cfg\(test\)\]\s*mod\s+(?:{'|'.join(names)})\s*;", owner.read_text())
        for owner in owners
    )


if __name__ == "__main__":
    sys.exit(main())
