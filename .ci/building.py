#!/usr/bin/env python3
"""Measures what building and testing splatref costs, and writes it into docs/building.md.

    .ci/building.py run FIGURE COMMAND...   run a command, and add its time to target/building.json
    .ci/building.py total SECONDS TIMES     note what .ci/run took so far; TIMES is what the shell's `times` printed
    .ci/building.py write                   write docs/building.md from target/building.json
    .ci/building.py check                   fail if a figure of this run grew by more than a tenth

Processor seconds differ from machine to machine, so `check` compares yardsticks: a figure divided by the
processor time that the dependencies took to compile in the same run. Machine code and the number of crates need
no yardstick.
"""
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
STATE = ROOT / "target" / "building.json"
PAGE = ROOT / "docs" / "building.md"
PROGRAM = ROOT / "target" / "release" / "splatref"
GROWTH = 1.1
# Four runs of nearly the same code differed by 8 %; the machine is shared.
NOISE = 1.1
TOTAL = ".ci/run but for what takes turns"

# Notes the processor time of each compiler run: RUSTC_WRAPPER is not part of what cargo calls fresh.
WRAPPER = """#!/usr/bin/env bash
"$@"; code=$?
name=-; for ((i = 1; i <= $#; i++)); do [ "${!i}" = --crate-name ] && { i=$((i + 1)); name=${!i}; break; }; done
file=$(mktemp "$BUILDING_TIMES/XXXXXXXX"); echo "$name $*" >"$file"; times >>"$file"
exit $code
"""


def load():
    return json.loads(STATE.read_text()) if STATE.exists() else {}


def seconds(text):
    minutes, rest = text.split("m")
    return 60 * float(minutes) + float(rest.rstrip("s"))


def compilers(folder):
    """Processor seconds of each crate; the tests of splatref are crates of their own."""
    crates = Counter()
    for file in Path(folder).iterdir():
        lines = file.read_text().splitlines()
        if len(lines) != 3 or lines[0].startswith("- "):
            continue
        name, *arguments = lines[0].split()
        if name == "splatref" and "--test" in arguments:
            name = "splatref (unit tests)"
        elif name == "splatref" and "bin" in arguments:
            name = "splatref (program)"
        crates[name] += sum(seconds(part) for part in lines[2].split())
    return dict(crates)


def run(figure, command):
    state = load()
    with tempfile.TemporaryDirectory() as folder:
        wrapper = Path(folder) / "wrapper"
        wrapper.write_text(WRAPPER)
        wrapper.chmod(0o755)
        times = Path(folder) / "times"
        times.mkdir()
        environment = dict(os.environ, RUSTC_WRAPPER=str(wrapper), BUILDING_TIMES=str(times))
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        code = subprocess.call(command, env=environment, cwd=ROOT)
        wall, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
        processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        crates = compilers(times)
    state[figure] = {"processor": processor, "wall": wall, "crates": crates}
    STATE.parent.mkdir(exist_ok=True)
    STATE.write_text(json.dumps(state, indent=1))
    print(f"{figure}: {processor:.0f} processor seconds, {wall:.0f} s")
    return code


def total(wall, times):
    state = load()
    processor = sum(seconds(part) for part in Path(times).read_text().split())
    state[TOTAL] = {"processor": processor, "wall": float(wall)}
    STATE.write_text(json.dumps(state, indent=1))


def dependencies(state):
    crates = state["cold build"]["crates"]
    return {name: time for name, time in crates.items() if not name.startswith("splatref")}


def code():
    """Bytes of machine code of each room of src/, and of everything else."""
    symbols = subprocess.run(["nm", "-C", "-S", PROGRAM], capture_output=True, text=True, check=True)
    rooms = Counter()
    # Address, size, kind and name; symbols without a size are no functions.
    for size, name in re.findall(r"^[0-9a-f]+ ([0-9a-f]+) [tTwW] (.*)$", symbols.stdout, re.M):
        room = re.search(r"splatref::(\w+)", name)
        rooms[room.group(1) if room else "dependencies and std"] += int(size, 16)
    return rooms


def figures(state):
    """Each figure that `check` compares, with the factor of noise that it may have."""
    yardstick = sum(dependencies(state).values())
    rooms = code()
    own = sum(size for room, size in rooms.items() if room != "dependencies and std")
    found = {"machine code of the crate, MB": (own / 1e6, 1), "crates compiled": (len(dependencies(state)), 1)}
    for figure in ["cold build", "quick suite", TOTAL]:
        if figure in state:
            found[f"{figure}, yardsticks"] = (state[figure]["processor"] / yardstick, NOISE)
    return found


def lines(folder):
    files = [folder] if folder.is_file() else folder.rglob("*.rs")
    return sum(len(file.read_text().splitlines()) for file in files)


def table(state):
    """The page's block."""
    out = ["| step | processor time | wall time |", "|---|---|---|"]
    for figure in ["cold build", "quick suite", TOTAL]:
        if figure in state:
            entry = state[figure]
            minutes, rest = divmod(round(entry["wall"]), 60)
            out.append(f"| {figure} | {entry['processor']:.0f} s | {minutes} min {rest} s |")
    out += ["", "What `.ci/run` compares; a yardstick is the time of all dependencies:", ""]
    out += ["| figure | value |", "|---|---|"]
    out += [f"| {name} | {value:.2f} |" for name, (value, _) in figures(state).items()]
    out += ["", "| room of `src/` | lines | machine code, kB |", "|---|---|---|"]
    rooms = code()
    places = [p for p in (ROOT / "src").iterdir() if p.is_dir() or p.stem not in ("lib", "main")]
    for place in sorted(places, key=lambda place: -rooms[place.stem]):
        out.append(f"| `{place.stem}` | {lines(place)} | {rooms[place.stem] / 1e3:.0f} |")
    out.append(f"| dependencies and std | | {rooms['dependencies and std'] / 1e3:.0f} |")
    out += ["", "| crate | processor time, s |", "|---|---|"]
    crates = Counter()
    for figure in ["cold build", "quick suite"]:
        for name, taken in state.get(figure, {}).get("crates", {}).items():
            crates[name] = max(crates[name], taken)
    out += [f"| `{name}` | {taken:.1f} |" for name, taken in crates.most_common(40)]
    return "\n".join(out)


def write():
    text = PAGE.read_text()
    begin, end = "<!-- building: figures -->\n", "<!-- end -->"
    head, rest = text.split(begin)
    tail = rest[rest.index(end) :]
    PAGE.write_text(f"{head}{begin}\n{table(load())}\n\n{tail}")


def check():
    known = dict(re.findall(r"^\| ([^|`]+?) \| ([0-9.]+) \|$", PAGE.read_text(), re.M))
    failed = False
    for name, (value, noise) in figures(load()).items():
        if name not in known:
            continue
        limit = float(known[name]) * GROWTH * noise
        grown = value > limit
        failed |= grown
        print(f"{'GREW  ' if grown else 'as was'} {name}: {value:.2f}, docs/building.md has {known[name]}")
    if failed:
        print("Find what grew (docs/building.md says how), or write the new figures: .ci/building.py write")
    return failed


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["run", figure, *command] if command:
            sys.exit(run(figure, command))
        case ["total", wall, times]:
            total(wall, times)
        case ["write"]:
            write()
        case ["check"]:
            sys.exit(check())
        case _:
            sys.exit(__doc__)
