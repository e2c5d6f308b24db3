#!/usr/bin/env python3
"""Runs the commands of the book (docs/) as they stand there, draws its pictures, and follows its links.

    python3 tools/book.py PROGRAM [--quick] [--pictures] [--links] [--only WORD]

Every page that docs/SUMMARY.md names has a folder of its own, with a copy of `testdata/`. The lines of its blocks marked ```sh are run there in order by bash, with PROGRAM as `meshwright`; each must end with
status 0, or with the one that a comment at its end tells (`# exit 3`). What a block marked ```text shows after them in the same section must be among what the last block
before it said, but for times and memory; `...` stands for what is left out. In blocks marked ```console a command begins with `$ `, and its answer follows. Blocks marked ```sh,ignore are counted, and not run. Comments of a page, which readers do not see, prepare what it needs:

    <!-- book: files part.stl=testdata/torus.ply -->   makes files, by `meshwright convert`
    <!-- book: shot page.html page.png -->             takes a picture of a page that a command has made (--pictures alone; needs playwright and Chromium)
    <!-- book: skips 2 -->                             how many commands of a page of the guide are not run
    <!-- book: run by tools/examples.py -->            leaves the page to another script

A picture `images/NAME.png` on a page of the guide is the NAME.png that a command of this page makes. With --pictures these are drawn again; else it is only checked that each exists and has its command. Every verb of
PROGRAM must be run by a page of docs/guide/verbs. --quick: larger voxels for the verbs that take longest, and small pictures. --only: the pages whose name has the word.

--links: every link and picture in the documents leads to a file, and every #anchor to a heading. Where the book is built (target/book, by `mdbook build docs`), the same of its pages, and that they load nothing from another host.
"""

import argparse
import html.parser
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.parse
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
PICTURES = DOCS / "guide" / "images"
BUILT = ROOT / "target" / "book"
RESOLUTION = 64
# The verbs that --quick gives larger voxels; others need those that they have, or take none.
SLOW = ["dilate", "erode", "open", "close", "canals", "field", "sdf"]
SIZE = {"--width": "240", "--height": "180"}
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]


# ---- pages ---------------------------------------------------------------------------------------------------------------


def pages():
    """The pages of the book, in its order."""
    summary = (DOCS / "SUMMARY.md").read_text()
    return [DOCS / name for name in re.findall(r"\]\(([^)]+\.md)\)", summary)]


def parts(page):
    """What a page has for this script, in order: ("directive", words), ("sh" and other kinds of block, lines), ("indented", line)."""
    kind, lines, fence = None, [], ""
    for line in page.read_text().splitlines():
        begins = re.match(r"\s*(`{3,})\s*([\w,+-]*)\s*$", line)
        if kind is not None:
            if line.strip() == fence:
                yield kind, lines
                kind = None
            else:
                lines.append(line)
        elif begins:
            kind, lines, fence = begins[2] or "plain", [], begins[1]
        elif found := re.fullmatch(r"<!-- book: (.*) -->", line.strip()):
            yield "directive", found[1].split()
        elif re.match(r" {4}\$? ?meshwright ", line):
            yield "indented", [line]
        elif line.strip():
            yield "words", [line]


def commands(lines):
    """The commands of a block, each with the status it must end with; a line that ends with a backslash goes on."""
    for line in re.sub(r"\\\n\s*", "", "\n".join(lines)).splitlines():
        if line.strip() and not line.startswith("#"):
            status = re.search(r"#.*\bexit (\d+)\s*$", line)
            yield line.strip(), int(status[1]) if status else 0


def quick(line):
    """The same command with large voxels and small pictures, and whether what it says may differ for that; a plan or a refusal is quick as it is."""
    if "--plan" in line or re.search(r"\bexit \d", line):
        return line, False
    changed = line
    if re.match(rf"meshwright (?:batch )?(?:{'|'.join(SLOW)}) ", line):
        resolution = lambda found: f"--resolution {min(int(found[1]), RESOLUTION)}"  # noqa: E731
        changed = re.sub(r"--resolution (\d+)", resolution, line)
        if "--resolution" not in line and "--voxel" not in line:
            changed += f" --resolution {RESOLUTION}"
    coarser = changed != line
    if re.match(r"meshwright render ", changed):
        for flag, size in SIZE.items():
            changed = re.sub(rf"{flag} \d+", f"{flag} {size}", changed) if flag in changed else changed.replace("render ", f"render {flag} {size} ", 1)
    return changed, coarser


def comparable(line):
    """A line without what differs from run to run and from machine to machine."""
    line = re.sub(r"\b[\d.,]+ (?:s|ms|min)\b", "TIME", line)
    line = re.sub(r"\b[\d.,]+ [kMG]?i?(?:B|bytes) of memory", "MEMORY", line)
    return " ".join(line.split())


def not_said(shown, told):
    """The first line of a block that the commands before it have not said."""
    told = [comparable(line) for line in told.splitlines()]
    for line in map(comparable, shown):
        if line in ("", "..."):
            continue
        begin, cut = re.subn(r" ?\.\.\.$", "", line)
        if not any(other.startswith(begin) if cut else other == line for other in told):
            return line
    return None


class Page:
    """A page whose commands are run in a folder of its own."""

    def __init__(self, path, folder, options):
        self.path, self.folder, self.options = path, folder, options
        self.name = str(path.relative_to(DOCS))
        self.run_lines, self.skipped, self.allowed, self.shown, self.faults, self.elsewhere = [], 0, 0, 0, [], None
        self.coarser = False
        shutil.copytree(ROOT / "testdata", folder / "testdata")
        self.environment = dict(os.environ, PATH=f"{options.bin}{os.pathsep}{os.environ['PATH']}", NO_COLOR="1")

    def run(self):
        told = None
        for kind, lines in parts(self.path):
            if kind == "directive":
                self.prepare(lines)
                continue
            if self.elsewhere:
                continue
            if kind == "sh":
                told = self.block(lines)
            elif kind == "console":
                told = self.block([line[2:] for line in lines if line.startswith("$ ")])
                self.compare([line for line in lines if not line.startswith("$ ")], told)
            elif kind == "text" and told is not None:
                self.compare(lines, told)
            elif kind == "words" and lines[0].startswith("#"):
                told = None
            elif kind == "sh,ignore":
                self.skipped += sum(1 for _ in commands(lines))
            elif kind not in ("words", "text") and any(re.match(r"\s*\$? ?meshwright [a-z]", line) for line in lines):
                self.faults.append(f"a command in a block that is not marked sh: {lines[0].strip()}")
        if self.skipped != self.allowed and PICTURES.parent in self.path.parents:
            self.faults.append(f"{self.skipped} commands are not run, and the page allows {self.allowed}")

    def prepare(self, words):
        if words[0] == "files":
            for word in words[1:]:
                name, source = word.split("=")
                self.bash(f"mkdir -p $(dirname {name}); meshwright convert {source} -o {name} -q", 0)
        elif words[0] == "shot":
            if self.options.pictures:
                shot(self.folder / words[1], self.folder / words[2])
            else:
                (self.folder / words[2]).touch()
        elif words[0] == "skips":
            self.allowed = int(words[1])
        elif words[:2] == ["run", "by"]:
            self.elsewhere = words[2]
        else:
            self.faults.append(f"not understood: {' '.join(words)}")

    def bash(self, line, status):
        done = subprocess.run(["bash", "-c", f"set -o pipefail; {line}"], cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600)
        if done.returncode != status:
            self.faults.append(f"exit {done.returncode}, not {status}, of {line}\n{done.stdout.strip()}")
        return done.stdout

    def block(self, lines):
        told = ""
        for line, status in commands(lines):
            self.run_lines.append(line)
            if self.options.quick:
                line, coarser = quick(line)
                self.coarser |= coarser
            told += self.bash(line, status)
        return told

    def compare(self, lines, told):
        if self.coarser:  # What a coarser run says is something else.
            return
        self.shown += 1
        if line := not_said(lines, told):
            self.faults.append(f"shows a line that no command says: {line}\n{told.strip()}")

    def pictures(self):
        """Compares the pictures that the page shows with those that it makes, and takes these where they are to be drawn again."""
        made = {path.name: path for path in self.folder.rglob("*.png") if "testdata" not in path.parts}
        used = set()
        for link in re.findall(r"!\[[^\]]*\]\(([^)\s]+)", self.path.read_text()):
            target = (self.path.parent / link).resolve()
            if target.parent == PICTURES and target.suffix == ".png" and PICTURES.parent in self.path.parents:
                used.add(target.name)
                if target.name not in made:
                    self.faults.append(f"no command makes {target.name}")
                elif self.options.pictures:
                    PICTURES.mkdir(exist_ok=True)
                    shutil.copy(made[target.name], target)
            if not target.exists():
                self.faults.append(f"{link} is not there")
        return used


def shot(page, picture):
    """A picture of a page, by Chromium."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as tool:
        browser = tool.chromium.launch(executable_path=os.environ.get("CHROMIUM") or shutil.which("chromium"), args=FLAGS)
        tab = browser.new_page(viewport={"width": 680, "height": 600})
        tab.goto(page.resolve().as_uri())
        tab.wait_for_selector("canvas[data-drawn='1']", state="attached", timeout=60000)
        tab.evaluate("const c = document.querySelector('canvas'); if (c.getBoundingClientRect().bottom > innerHeight) c.scrollIntoView({block: 'end'})")
        tab.wait_for_timeout(500)
        tab.screenshot(path=str(picture))
        browser.close()


def verbs(program):
    """The verbs that the program lists."""
    told = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    listed = told.split("Commands:\n")[1].split("\n\n")[0]
    return [word for word in re.findall(r"^  (\S+)", listed, flags=re.M) if word != "help"]


def run_pages(options):
    faults, run, skipped, verbs_run, used = [], 0, 0, set(), set()
    with tempfile.TemporaryDirectory() as scratch:
        options.bin = Path(scratch, "bin")
        options.bin.mkdir()
        (options.bin / "meshwright").symlink_to(os.path.abspath(options.program))
        for number, path in enumerate(pages()):
            if options.only not in str(path.relative_to(DOCS)):
                continue
            folder = Path(scratch, f"page_{number}")
            folder.mkdir()
            started = time.time()
            page = Page(path, folder, options)
            page.run()
            used |= page.pictures()
            faults += [f"{page.name}: {fault}" for fault in page.faults]
            run, skipped = run + len(page.run_lines), skipped + page.skipped
            if path.parent == DOCS / "guide" / "verbs":
                verbs_run |= {word for line in page.run_lines for word in re.findall(r"\bmeshwright ([a-z]+)", line)}
            if page.elsewhere:
                print(f"{'':11}{page.name}: run by {page.elsewhere}")
            elif page.run_lines or page.skipped:
                print(f"{time.time() - started:8.1f} s {page.name}: {len(page.run_lines)} run, {page.skipped} not, {page.shown} answers compared", flush=True)
            shutil.rmtree(folder)
    if not options.only:
        faults += [f"no page of docs/guide/verbs runs {verb}" for verb in verbs(options.program) if verb not in verbs_run]
        faults += [f"{path.relative_to(ROOT)} is on no page of the guide" for path in sorted(PICTURES.glob("*.png")) if path.name not in used]
        listed = set(pages())
        faults += [f"{path.relative_to(ROOT)} is not in SUMMARY.md" for path in sorted(DOCS.rglob("*.md")) if path not in listed and path.name != "SUMMARY.md"]
    print(f"{run} commands run, {skipped} not")
    return faults


# ---- links ---------------------------------------------------------------------------------------------------------------


def documents():
    """The documents whose links are followed."""
    found = [ROOT / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md")]
    return found + sorted(DOCS.rglob("*.md")) + sorted((ROOT / "python").glob("*.md")) + sorted((ROOT / "fuzz").glob("*.md"))


def prose(text):
    """A document without its blocks of code."""
    return re.sub(r"^\s*(`{3,}).*?^\s*\1\s*$", "", text, flags=re.S | re.M)


def anchors(path):
    """The anchors of a document's headings."""
    found, times = set(), {}
    for heading in re.findall(r"^#{1,6}\s+(.+?)\s*#*$", prose(path.read_text()), flags=re.M):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        times[slug] = times.get(slug, -1) + 1
        found.add(slug if times[slug] == 0 else f"{slug}-{times[slug]}")
    return found


def follow_documents():
    faults, known, count = [], {}, 0
    for path in documents():
        text = re.sub(r"`[^`\n]*`", "", prose(path.read_text()))
        for link in re.findall(r"\]\(([^)\s]+)(?:\s+\"[^\"]*\")?\)", text):
            address = urllib.parse.urlsplit(link)
            if address.scheme:
                continue
            count += 1
            target = (path.parent / urllib.parse.unquote(address.path)).resolve() if address.path else path
            if not target.exists():
                faults.append(f"{path.relative_to(ROOT)}: {link} leads nowhere")
            elif address.fragment and target.suffix == ".md":
                if target not in known:
                    known[target] = anchors(target)
                if address.fragment not in known[target]:
                    faults.append(f"{path.relative_to(ROOT)}: {link} has no such heading")
    print(f"{count} links in {len(documents())} documents")
    return faults


class Links(html.parser.HTMLParser):
    """What a page refers to, what of it is loaded without being asked for, and its own anchors."""

    def __init__(self, text):
        super().__init__()
        self.links, self.loaded, self.ids = [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("id", "name") and value:
                self.ids.add(value)
            if name in ("href", "src", "data", "poster") and value and tag != "base":
                (self.links if tag == "a" else self.loaded).append(value)


def follow_book():
    if not BUILT.exists():
        return ["target/book is not there: mdbook build docs"]
    faults, count = [], 0
    read = {path: Links(path.read_text()) for path in sorted(BUILT.rglob("*.html"))}
    for path, found in read.items():
        name = path.relative_to(BUILT)
        for link in found.loaded + found.links:
            address = urllib.parse.urlsplit(link)
            if address.scheme == "data" or link in found.links and address.scheme in ("http", "https", "mailto"):
                continue
            if address.scheme or address.netloc:
                faults.append(f"{name} loads {link}")
                continue
            count += 1
            place = BUILT / address.path.lstrip("/") if address.path.startswith("/") else path.parent / urllib.parse.unquote(address.path)
            target = place.resolve() if address.path else path
            if not target.exists():
                faults.append(f"{name}: {link} leads nowhere")
            elif address.fragment and target in read and address.fragment not in read[target].ids:
                faults.append(f"{name}: {link} has no such anchor")
        if 'class="playground"' in path.read_text():
            faults.append(f"{name} has a button that asks another host to run code")
    for path in BUILT.rglob("*.css"):
        faults += [f"{path.relative_to(BUILT)} loads {link}" for link in re.findall(r"(?:url\(|@import)\s*[\"']?((?:https?:)?//[^\"')\s]+)", path.read_text())]
    print(f"{count} links in {len(read)} pages of the book")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--pictures", action="store_true")
    parser.add_argument("--links", action="store_true")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    if options.quick and options.pictures:
        parser.error("quick pictures are not worth keeping")
    faults = run_pages(options)
    if options.links:
        faults += follow_documents() + follow_book()
    sys.exit("\n".join(faults) or 0)


if __name__ == "__main__":
    main()
