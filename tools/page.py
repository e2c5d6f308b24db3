#!/usr/bin/env python3
"""Looks at the pages of `--report FILE.html` in a browser without a window.

    python3 tools/page.py [--program PATH] [--meshes FOLDER] [--keep FOLDER] [--required]

Makes the pages of five repairs, a boolean, a comparison, a list of canals and an inspection, of `testdata/` (or of the meshes of a folder, by `--meshes`, besides), opens each in
Chromium and checks: no error on the console, no request but for the page itself, a canvas of several colours, a camera that goes where the third place of a table is, or
the last of fewer, layers that change what is drawn, two pages of paper, and text and pictures with scripts off.

Needs the package `playwright` and a Chromium (`chromium` in the path, or CHROMIUM=path). Without them it says so and ends with 0; with 1 where `--required` asks for them.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]

RUNS = {
    "mug": "repair testdata/broken_mug.obj -o OUT/mug.ply",
    "cube": "repair testdata/open_cube.off -o OUT/cube.stl",
    "boxes": "repair testdata/overlapping_boxes.obj -o OUT/boxes.stl",
    "doubled": "repair testdata/doubled_faces.off -o OUT/doubled.stl",
    "ball": "repair testdata/cracked_ball.stl -o OUT/ball.stl",
    "difference": "difference testdata/hollow_ball.stl testdata/inside_out_cube.stl -o OUT/difference.stl",
    "compare": "compare testdata/torus.ply testdata/noisy_cube.off",
    "canals": "canals testdata/bored_block.off --max-diameter 3% --resolution 64",
    "inspect": "inspect testdata/broken_mug.obj --holes",
}

# Of a mesh: the pixels of the canvas, every 31st.
PIXELS = """() => { const c = document.querySelector('canvas'), d = document.createElement('canvas'); d.width = c.width; d.height = c.height;
  const x = d.getContext('2d'); x.drawImage(c, 0, 0); const all = x.getImageData(0, 0, d.width, d.height).data, some = [];
  for (let n = 0; n < all.length; n += 4 * 31) some.push(all[n] << 16 | all[n + 1] << 8 | all[n + 2]); return some; }"""


def made(program, line, folder, name):
    """The page of a run."""
    page = folder / f"{name}.html"
    words = line.replace("OUT", str(folder)).split() + ["--report", str(page), "-q"]
    done = subprocess.run([program, *words], cwd=ROOT, capture_output=True, text=True)
    if not page.exists():
        raise SystemExit(f"{name}: no page ({done.returncode}): {done.stderr}")
    return page


def differs(before, after):
    return sum(a != b for a, b in zip(before, after))


def drawn(tab, action):
    """What is drawn after something was done."""
    tab.evaluate("document.querySelector('canvas').dataset.drawn = ''")
    action()
    tab.wait_for_selector("canvas[data-drawn='1']", state="attached", timeout=30000)
    tab.wait_for_timeout(60)
    return tab.evaluate(PIXELS)


def settled(tab):
    before = None
    for _ in range(100):
        now = tab.get_attribute("canvas", "data-camera")
        if now == before:
            return now
        before = now
        tab.wait_for_timeout(250)
    return before


def look(browser, page, faults, keep):
    """Opens a page and says what is wrong with it."""
    name, address = page.stem, page.resolve().as_uri()
    fault = lambda text: faults.append(f"{name}: {text}")
    tab = browser.new_page(viewport={"width": 1200, "height": 900})
    tab.on("console", lambda message: fault(f"console: {message.text}"))
    tab.on("pageerror", lambda error: fault(f"error: {error}"))
    out = lambda request: request.url != address and not request.url.startswith(("data:", "blob:"))
    tab.on("request", lambda request: fault(f"asks for {request.url[:100]}") if out(request) else None)
    tab.goto(address)
    tab.wait_for_selector("canvas[data-drawn='1']", timeout=60000)
    pixels = tab.evaluate(PIXELS)
    if len(set(pixels)) < 8:
        fault(f"the canvas has {len(set(pixels))} colours")
    for box in tab.query_selector_all("#stage input[type=checkbox]"):
        layer = box.get_attribute("value")
        before = tab.evaluate(PIXELS)
        after = drawn(tab, box.click)
        marks = tab.locator("#stage .mark").count() > 0
        if differs(before, after) == 0 and not (marks and layer in ("Holes", "Canals")):
            fault(f"the layer {layer!r} changes nothing")
        drawn(tab, box.click)
    colours = tab.query_selector_all("#stage input[type=radio]")
    seen = {tuple(drawn(tab, colour.click)) for colour in colours}
    # Where all is kept, what each triangle is looks plain.
    if len(seen) < len(colours) - 1:
        fault(f"{len(colours)} colourings give {len(seen)} pictures")
    places = tab.locator("#defects tr[data-at]")
    if places.count():
        before = settled(tab)
        places.nth(min(2, places.count() - 1)).locator("button").click()
        tab.wait_for_timeout(600)
        if settled(tab) == before:
            fault("choosing a place does not move the camera")
    elif tab.locator("#defects").count() and "None was found" not in tab.inner_text("#defects"):
        fault("no row has a place")
    paper = tab.pdf(prefer_css_page_size=True)
    pages = len(re.findall(rb"/Type\s*/Page\b", paper))
    if not 1 <= pages <= 2:
        fault(f"{pages} pages of paper")
    if keep:
        for scheme, width in [("light", 1200), ("dark", 1200), ("light", 390)]:
            tab.set_viewport_size({"width": width, "height": 900})
            tab.emulate_media(color_scheme=scheme)
            tab.wait_for_timeout(300)
            tab.screenshot(path=keep / f"{name}-{scheme}-{width}.png", full_page=True)
        (keep / f"{name}.pdf").write_bytes(paper)
    tab.close()
    context = browser.new_context(java_script_enabled=False)
    bare = context.new_page()
    bare.goto(address)
    if not bare.locator("#pictures img").first.is_visible() or bare.locator("#stage").is_visible():
        fault("with scripts off there are no pictures")
    context.close()
    return pages


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "target/debug/meshwright"))
    parser.add_argument("--meshes", type=Path, help="a folder of meshes, each of which is repaired")
    parser.add_argument("--keep", type=Path, help="where pictures and papers go")
    parser.add_argument("--required", action="store_true")
    args = parser.parse_args()
    chromium = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        sync_playwright = None
    if not chromium or not sync_playwright:
        print("pages were not looked at: " + ("no Chromium is here" if not chromium else "the package playwright is not here"))
        return int(args.required)
    faults = []
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as play:
        folder = Path(folder)
        if args.keep:
            args.keep.mkdir(parents=True, exist_ok=True)
        runs = dict(RUNS)
        for mesh in sorted(args.meshes.iterdir()) if args.meshes else []:
            runs[mesh.stem] = f"repair {mesh} -o OUT/{mesh.stem}.stl"
        browser = play.chromium.launch(executable_path=chromium, args=FLAGS)
        for name, line in runs.items():
            page = made(args.program, line, folder, name)
            papers = look(browser, page, faults, args.keep)
            print(f"{name}: {page.stat().st_size / 1e6:.2f} MB, {papers} pages of paper")
        browser.close()
    print("\n".join(faults) or "nothing is wrong with any page")
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main())
