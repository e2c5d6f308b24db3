#!/usr/bin/env python3
"""Runs the program under faults: the matrix of docs/reliability.md.

tools/faults.py PROGRAM [--quick] [--kills 200] [--seed 1]

Every row is a kind of fault: how often it was tried, and how the runs ended. A run is wrong when its status or its sentence is
another than the one that is documented, when a file is half written, or when something is left behind that the next run does not
clear. Exits with 1 when anything is wrong. Linux only; as root it also becomes another user, to be refused. --quick: fewer of each, under a minute.
"""

import argparse
import json
import math
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

DONE, USAGE, INPUT, MEMORY, DEADLINE, WRITE, INTERRUPTED = 0, 2, 4, 5, 6, 7, 130
NOBODY = 65534


def ball(path, n, shift=0.0, hole=False):
    """A ball of about 2 n² triangles in rings, closed at the poles or without its cap."""
    lines, faces = [], []
    for i in range(1, n):
        for k in range(n):
            a, b = math.pi * i / n, 2 * math.pi * k / n
            lines.append("%.9g %.9g %.9g" % (shift + math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a)))
    at = lambda i, k: (i - 1) * n + k % n
    for i in range(3 if hole else 1, n - 1):
        for k in range(n):
            faces += [(at(i, k), at(i + 1, k), at(i + 1, k + 1)), (at(i, k), at(i + 1, k + 1), at(i, k + 1))]
    south = len(lines)
    lines.append("0 0 -1" if not shift else "%.9g 0 -1" % shift)
    faces += [(at(n - 1, k), south, at(n - 1, k + 1)) for k in range(n)]
    if not hole:
        lines.append("%.9g 0 1" % shift)
        faces += [(south + 1, at(1, k), at(1, k + 1)) for k in range(n)]
    text = ["OFF", f"{len(lines)} {len(faces)} 0", *lines, *("3 %d %d %d" % face for face in faces)]
    path.write_text("\n".join(text) + "\n")


class Bench:
    """The program, a folder to work in, and the rows."""

    def __init__(self, program, folder, quick, seed):
        self.program, self.folder, self.quick = str(Path(program).resolve()), folder, quick
        self.random = random.Random(seed)
        self.rows, self.wrong = [], []
        self.inputs = folder / "in"
        self.inputs.mkdir()
        ball(self.inputs / "small.off", 24, hole=True)
        ball(self.inputs / "open.off", 90, hole=True)
        ball(self.inputs / "other.off", 90, shift=0.7, hole=True)
        self.small, self.open, self.other = (self.inputs / f"{name}.off" for name in ("small", "open", "other"))

    def fresh(self):
        """An empty folder, which anybody may write into."""
        folder = self.folder / "out"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        folder.chmod(0o777)
        return folder

    def start(self, *words, **more):
        more = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | more
        return subprocess.Popen([self.program, *map(str, words)], **more)

    def run(self, *words, limit=60, **more):
        process = self.start(*words, **more)
        try:
            out, error = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            return "hangs", b"", ""
        return process.returncode, out or b"", (error or b"").decode(errors="replace")

    def row(self, fault, results, wrong=()):
        counted = ", ".join(f"{count} × {name}" for name, count in Counter(results).most_common())
        self.rows.append((fault, len(results), counted))
        for what in wrong:
            self.wrong.append(f"{fault}: {what}")
            print(f"WRONG: {fault}: {what}", file=sys.stderr)
        print(f"| {fault} | {len(results)} | {counted} |", flush=True)

    def expect(self, fault, status, words, runs, left=()):
        """Runs that must all end with `status`, say `words`, and leave only files called `left`."""
        results, wrong = [], []
        for command, more in runs:
            folder = more.pop("folder", None) or self.fresh()
            command = [str(word).replace("OUT", str(folder)) for word in command]
            code, _, said = self.run(*command, **more)
            results.append(name(code))
            names = sorted(path.name for path in folder.iterdir())
            if code != status or (words not in said):
                wrong.append(f"{' '.join(command)}: {code}, {said.strip()!r}")
            if "internal error" in said or "os error" in said or "panicked" in said:
                wrong.append(f"a sentence that is none: {said.strip()!r}")
            if [n for n in names if n not in left]:
                wrong.append(f"left behind: {names}")
        self.row(fault, results, wrong)


def name(code):
    if isinstance(code, str):
        return code
    return f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit {code}"


def hidden(folder):
    return [path.name for path in folder.iterdir() if path.name.startswith(".")]


def kills(bench, count):
    """SIGKILL at a random time of runs with a map and a report, in a folder where an earlier result lies."""
    ways = [["repair", bench.open], ["union", bench.open, bench.other]]
    folder = bench.fresh()
    sets, times, whole = [], [], []
    names = ["mesh.stl", "map.ply", "report.json"]
    for way in ways:
        command = [*way, "-o", folder / names[0], "--map", folder / names[1], "--report", folder / names[2], "--resolution", "64"]
        start = time.monotonic()
        assert bench.run(*command, "-q")[0] == DONE
        times.append(time.monotonic() - start)
        sets.append(command)
        whole.append({n: (folder / n).read_bytes() for n in names[:2]})
    results, wrong, cleared = [], [], []
    for n in range(count):
        command, files, usual = sets[n % 2], whole[n % 2], times[n % 2]
        before = bench.random.random() < 0.5
        for file in names:
            (folder / file).unlink(missing_ok=True)
            if before:
                (folder / file).write_text("before")
        process = bench.start(*command, "-q")
        if n % 4 < 2:
            time.sleep(usual * bench.random.uniform(0, 1.05))
        else:
            # Half of them where files are written.
            while process.poll() is None and not any(f".meshwright-{process.pid}-" in path for path in hidden(folder)):
                time.sleep(0.0002)
            time.sleep(usual * bench.random.uniform(0, 0.04))
        process.kill()
        process.communicate()
        states = []
        for file in names:
            path = folder / file
            if not path.exists() or before and path.read_bytes() == b"before":
                states.append("old")
            elif file == "report.json":
                try:
                    states.append("new" if json.loads(path.read_text())["exit"] == 0 else "half")
                except ValueError:
                    states.append("half")
            else:
                states.append("new" if path.read_bytes() == files[file] else "half")
        results.append("nothing new" if set(states) == {"old"} else "all new" if set(states) == {"new"} else "half" if "half" in states else "each whole, some new")
        if "half" in states:
            wrong.append(f"run {n}: {dict(zip(names, states))}")
        mine = any(f".meshwright-{process.pid}-" in path for path in hidden(folder))
        results[-1] += ", temporary files left" if mine else ""
        # The next run clears them, also when it is killed in its turn; one that is let to its end shows it.
        if mine and n % 5 == 0 or n == count - 1:
            left = hidden(folder)
            done = bench.run(*command, "-q")[0]
            cleared.append("cleared" if done == DONE and not hidden(folder) else "not cleared")
            if cleared[-1] != "cleared":
                wrong.append(f"{left} not cleared: {done}, {hidden(folder)}")
    bench.row("SIGKILL at a random time, half of them while files are written; with mesh, map and report", results, wrong)
    bench.row("the next run after such a one", cleared)


def fill(fd):
    os.set_blocking(fd, False)
    try:
        while True:
            os.write(fd, b"x" * 4096)
    except BlockingIOError:
        pass
    os.set_blocking(fd, True)


def blocked(bench, count):
    """Pipes that nobody reads from, full from the start or filled by the run."""
    # From voxels, which takes longer than it takes the signal to come.
    commands = {
        "mesh on standard output": (["repair", bench.open, "-o", "-", "--out-format", "stl", "--resolution", "64"], 1),
        "report on standard output": (["inspect", bench.open, "--json"], 1),
        "lattice on standard output": (["sdf", bench.open, "-o", "-", "--out-format", "nrrd", "--resolution", "64"], 1),
        "standard error": (["repair", bench.open, "-o", bench.folder / "out" / "m.stl", "--method", "voxel", "--resolution", "512", "-v"], 2),
    }
    stops = [("--timeout", DEADLINE), ("SIGTERM", INTERRUPTED), ("SIGINT", INTERRUPTED), ("SIGINT twice", INTERRUPTED)]
    for stop, status in stops:
        results, wrong, slowest = [], [], 0.0
        for n in range(count):
            for what, (command, stream) in commands.items():
                folder = bench.fresh()
                read, write = os.pipe()
                fill(write)
                extra = ["--timeout", "0.9s"] if stop == "--timeout" else []
                process = bench.start(*command, *extra, **{"stdout" if stream == 1 else "stderr": write})
                start = time.monotonic()
                allowed = 0.9 + 1.5
                if stop != "--timeout":
                    time.sleep(0.5 + 0.1 * n)
                    start, allowed = time.monotonic(), 1.5
                    number = signal.SIGTERM if stop == "SIGTERM" else signal.SIGINT
                    process.send_signal(number)
                    if "twice" in stop:
                        time.sleep(0.1)
                        process.send_signal(number)
                try:
                    process.wait(timeout=10)
                    code = process.returncode
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
                    code = "hangs"
                took = time.monotonic() - start
                slowest = max(slowest, took)
                for pipe in (process.stdout, process.stderr):
                    if pipe:
                        pipe.close()
                os.close(read)
                os.close(write)
                results.append(name(code))
                if code != status or took > allowed or list(folder.iterdir()):
                    wrong.append(f"{what}: {code} after {took:.2f} s, {list(folder.iterdir())}")
        bench.row(f"a pipe that nobody reads, {stop}; the slowest took {slowest:.1f} s", results, wrong)


def stops(bench, count):
    """Signals at random times of ordinary runs."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        results, wrong, slowest = [], [], 0.0
        for _ in range(count):
            folder = bench.fresh()
            # Before the first 50 ms the program may not be listening yet, and dies by the signal.
            process = bench.start("repair", bench.open, "-o", folder / "m.stl", "--map", folder / "m.ply", "--method", "voxel", "--resolution", "320")
            time.sleep(bench.random.uniform(0.05, 0.9))
            start = time.monotonic()
            process.send_signal(number)
            process.communicate()
            slowest = max(slowest, time.monotonic() - start)
            results.append(name(process.returncode))
            files = sorted(path.name for path in folder.iterdir())
            if (process.returncode, files) not in [(INTERRUPTED, []), (DONE, ["m.ply", "m.stl"])]:
                wrong.append(f"{process.returncode}, {files}")
        bench.row(f"{number.name} at a random time; the slowest took {slowest:.1f} s", results, wrong)


def limited(kind, amount):
    return lambda: resource.setrlimit(kind, (amount, resource.getrlimit(kind)[1]))


def full(bench):
    sides = ["--map", "OUT/m.ply", "--report", "OUT/r.json"]
    small = ["repair", bench.small, "--resolution", "48"]
    bench.expect("disk full (/dev/full): mesh, map, report, lattice, picture, table", WRITE, "No space left", [
        ([*small, "-o", "/dev/full", "--out-format", "stl"], {}),
        ([*small, "-o", "OUT/m.stl", "--map", "/dev/full"], {}),
        ([*small, "-o", "OUT/m.stl", "--report", "/dev/full"], {}),
        (["sdf", bench.small, "-o", "/dev/full", "--out-format", "vdb", "--resolution", "32"], {}),
        (["render", bench.small, "-o", "/dev/full"], {}),
        (["inspect", bench.small], {"stdout": open("/dev/full", "wb")}),
        (["convert", bench.small, "-o", "-", "--out-format", "stl"], {"stdout": open("/dev/full", "wb")}),
    ])
    runs = []
    for most in (1, 1000, 20_000):
        for command in ([*small, "-o", "OUT/m.stl", *sides], ["convert", bench.open, "-o", "OUT/m.3mf"], ["sdf", bench.small, "-o", "OUT/m.nrrd", "--resolution", "48"]):
            runs.append((command, {"preexec_fn": limited(resource.RLIMIT_FSIZE, most)}))
    bench.expect("a file grows beyond the limit of its size (1 byte to 20 kB)", WRITE, "File too large", runs, left=["r.json"])
    if os.geteuid() == 0:
        disk = bench.folder / "disk"
        disk.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "none", disk], capture_output=True).returncode == 0:
            try:
                (disk / "m.stl").write_text("before")
                runs = [(["repair", bench.open, "--resolution", "64", "-o", "OUT/m.stl", *sides], {"folder": disk}),
                        (["convert", bench.open, "-o", "OUT/m.stl"], {"folder": disk})]
                bench.expect("disk full (a file system of 256 kB)", WRITE, "No space left", runs, left=["m.stl", "r.json"])
                assert (disk / "m.stl").read_text() == "before"
            finally:
                subprocess.run(["umount", disk], check=True)


def gone(bench):
    """Readers that go away, and folders that cannot be written."""
    runs = []
    for command in (["convert", bench.open, "-o", "-", "--out-format", "stl"], ["inspect", bench.open], ["inspect", bench.open, "--json"],
                    ["sdf", bench.small, "-o", "-", "--out-format", "npy", "--resolution", "64"],
                    ["repair", bench.small, "-o", "OUT/m.stl", "--report", "OUT/r.json", "--json", "--resolution", "32"]):
        read, write = os.pipe()
        os.close(read)
        runs.append((command, {"stdout": write}))
    bench.expect("broken pipe on standard output", WRITE, "stopped reading", runs)
    places = ["/sys"] + (["OUT"] if os.geteuid() == 0 else [])
    for place in places:
        runs = []
        for flags in (["-o", f"{place}/m.stl"], ["-o", "/dev/null", "--out-format", "stl", "--map", f"{place}/m.ply"], ["-o", "/dev/null", "--out-format", "stl", "--report", f"{place}/r.json"]):
            more = {}
            if place == "OUT":
                more = {"folder": bench.fresh(), "user": NOBODY}
                more["folder"].chmod(0o555)
            runs.append((["repair", bench.small, *flags], more))
        bench.expect(f"a folder that cannot be written ({'read-only' if place == 'OUT' else place})", WRITE, "cannot write into", runs)


def aliases(bench):
    folder = bench.fresh()
    shutil.copy(bench.small, folder / "in.off")
    (folder / "sub").mkdir()
    os.symlink("sub", folder / "way")
    os.symlink("in.off", folder / "link.off")
    os.link(folder / "in.off", folder / "second.off")
    kept = {"folder": folder}
    left = ["in.off", "sub", "way", "link.off", "second.off"]
    repair = ["repair", "OUT/in.off", "--resolution", "32"]
    bench.expect("an input as an output, by another path, a link or a second name", USAGE, "is an input", [
        ([*repair, "-o", path], dict(kept)) for path in ("OUT/in.off", "OUT/./in.off", "OUT/way/../in.off", "OUT/link.off", "OUT/second.off")
    ] + [([*repair, "-o", "OUT/m.stl", flag, path], dict(kept)) for flag in ("--map", "--report") for path in ("OUT/./in.off", "OUT/link.off")], left)
    bench.expect("two outputs that are one file, there or not yet", USAGE, "are the same file", [
        ([*repair, "-o", a, flag, b], dict(kept)) for flag in ("--map", "--report")
        for a, b in (("OUT/m.ply", "OUT/./m.ply"), ("OUT/sub/m.ply", "OUT/way/m.ply"), ("OUT/m.ply", "OUT/sub/../m.ply"))
    ], left)
    for link, to in (("nowhere.off", "absent.off"), ("self.off", "self.off"), ("there.off", "back.off"), ("back.off", "there.off")):
        os.symlink(to, folder / link)
    left += ["nowhere.off", "self.off", "there.off", "back.off"]
    links = ["nowhere.off", "self.off", "there.off"]
    bench.expect("a link that leads nowhere or in a ring, as an output", USAGE, "a link that leads", [([*repair, "-o", f"OUT/{link}"], dict(kept)) for link in links], left)
    bench.expect("the same as an input", INPUT, "a link that leads", [(["repair", f"OUT/{link}", "-o", "OUT/m.stl"], dict(kept)) for link in links], left)


def starved(bench, steps):
    """Limits of memory and threads: done, or refused with a sentence."""
    # How far the first is from its plan shows in docs/benchmarks.md; the others have no plan, or another.
    verbs = [["repair", bench.open, "-o", "OUT/m.stl", "--method", "voxel", "--resolution", "256"], ["union", bench.open, bench.other, "-o", "OUT/m.stl", "--resolution", "192"],
             ["inspect", bench.open], ["sdf", bench.open, "-o", "OUT/m.nrrd", "--resolution", "192"], ["dilate", bench.open, "-o", "OUT/m.stl", "--radius", "4h", "--resolution", "128"]]
    if bench.quick:
        verbs = verbs[:3]

    def tried(fault, limit, amounts, more=None):
        results, wrong = [], []
        for amount in amounts:
            for verb in verbs:
                folder = bench.fresh()
                code, _, said = bench.run(*[str(word).replace("OUT", str(folder)) for word in verb], preexec_fn=limited(limit, amount), limit=120, **(more or {}))
                bare = code == MEMORY and "error: " not in said
                results.append(name(code) + (" by the allocator, without a hint" if bare else ""))
                left = [path.name for path in folder.iterdir()]
                if code not in (DONE, 3, MEMORY) or code == MEMORY and not said.strip() or code == MEMORY and [n for n in left if not n.startswith(".")]:
                    wrong.append(f"{amount} {verb[0]}: {code} {said.strip()!r} {left}")
        bench.row(fault, results, wrong)

    low, high = 60e6, 1.2e9
    amounts = [int(low * (high / low) ** (k / (steps - 1))) for k in range(steps)]
    tried(f"address space limited (ulimit -v), {low / 1e6:.0f} MB to {high / 1e9:.1f} GB", resource.RLIMIT_AS, amounts)
    tried("data limited (ulimit -d), the same", resource.RLIMIT_DATA, amounts)
    if os.geteuid() == 0:
        taken = sum(1 for path in Path("/proc").iterdir() if path.name.isdigit() and owner(path) == NOBODY)
        tried("processes limited (ulimit -u), 1 to 8", resource.RLIMIT_NPROC, [taken + k for k in range(1, 9 if steps > 6 else 5)], {"user": NOBODY})


def owner(path):
    try:
        return path.stat().st_uid
    except OSError:
        return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--kills", type=int)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    quick = args.quick
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        os.chmod(folder, 0o755)
        program = Path(folder) / "meshwright"
        shutil.copy(args.program, program)
        program.chmod(0o755)
        bench = Bench(program, Path(folder), quick, args.seed)
        print("| fault | runs | result |\n|---|---|---|")
        kills(bench, args.kills or (12 if quick else 200))
        stops(bench, 2 if quick else 20)
        blocked(bench, 1 if quick else 5)
        full(bench)
        gone(bench)
        aliases(bench)
        starved(bench, 4 if quick else 16)
        print(f"\n{sum(runs for _, runs, _ in bench.rows)} runs, {len(bench.wrong)} wrong")
        sys.exit(bool(bench.wrong))


if __name__ == "__main__":
    main()
