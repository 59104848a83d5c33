"""Measures what the package costs beside the library: time of a call, and memory of large arrays.

    python python/benches/measure.py

Needs the package as `pip install ./python` builds it, and a quiet machine. Prints Markdown.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time

COUNT, SIZE, ROUNDS, TURNS = 100_000, 512, 40, 5
POINTS = 10_000_000

MEMORY = """
import resource, numpy as np, splatref as sr
held = lambda: int(open("/proc/self/statm").read().split()[1]) * 4096 / 2**20
n = {points}
positions = np.random.default_rng(1).random((n, 3), np.float32)
normals = np.zeros((n, 3), np.float32); normals[:, 2] = 1
radii = np.full(n, 1e-3, np.float32)
size = (positions.nbytes + normals.nbytes + radii.nbytes) / 2**20
before = held()
scene = sr.Scene(positions, normals=normals, radii=radii)
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(f"{{size:.0f}} {{held() - before:.0f}} {{peak - before:.0f}}")
"""


def library() -> list[float]:
    """Milliseconds of pictures by the library, the least and the median; each has a session of its own."""
    bench = ["cargo", "bench", "-p", "splatref-python", "--profile", "release", "--bench", "library", "--"]
    numbers = [str(COUNT), str(SIZE), str(ROUNDS)]
    said = subprocess.run([*bench, *numbers], stdout=subprocess.PIPE, text=True, check=True).stdout
    return [float(number) for number in said.split()]


def package() -> list[float]:
    """The same through Python."""
    import splatref as sr

    scene, camera = sr.Scene.open("torus", count=COUNT), sr.Camera(size=(SIZE, SIZE))
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        picture = sr.render(scene, camera)
        times.append(1000 * (time.perf_counter() - start))
        del picture
    return [min(times), statistics.median(times)]


def main() -> None:
    pairs = [(library(), package()) for _ in range(TURNS)]
    print(f"`sr.render` of {COUNT} surfels at {SIZE} x {SIZE}, {ROUNDS} pictures a turn:\n")
    print("| turn | library, least and median | Python, least and median | more |\n|---|---|---|---|")
    for turn, (ours, theirs) in enumerate(pairs):
        more = f"{100 * (theirs[0] / ours[0] - 1):+.1f} %, {100 * (theirs[1] / ours[1] - 1):+.1f} %"
        print(f"| {turn} | {ours[0]:.2f}, {ours[1]:.2f} ms | {theirs[0]:.2f}, {theirs[1]:.2f} ms | {more} |")
    code = MEMORY.format(points=POINTS)
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    size, kept, peak = (int(number) for number in said.split())
    print(f"\nArrays of {POINTS} points, {size} MiB: the scene holds {kept} MiB, and {peak} MiB at its peak.")


if __name__ == "__main__":
    main()
