"""Writes a scene of many different parts, each of them once: meshes to try `splatref surfels SCENE -o FOLDER` with.

    python examples/python/many_parts.py 100000000 parts
    splatref surfels parts/scene.toml -o parts/levels
    splatref render parts/walk.toml --frames all --target-ms 500 -o parts/walk.exr

Pipes, vessels, bumpy rings, rocks, stacks of boxes, trusses and plants stand along a street on hilly ground. The largest part
has up to a thousand times as many triangles as the smallest. `walk.toml` shows the levels: down from an overview, then along
the street.
"""

import sys
from pathlib import Path

import numpy as np

total = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
folder = Path(sys.argv[2] if len(sys.argv) > 2 else "parts")
random = np.random.default_rng(1)
TURN = 2 * np.pi


def surface(count, at, long=1):
    """About `count` triangles, in `long` times as many rows as columns; `at` gets s and t, from 0 to 1, and gives x, y, z."""
    columns = max(3, round((count / 2 / long) ** 0.5))
    rows = max(3, round(count / 2 / columns))
    s, t = np.meshgrid(np.linspace(0, 1, rows + 1), np.linspace(0, 1, columns + 1), indexing="ij")
    places = np.stack(np.broadcast_arrays(*at(s, t)), -1).reshape(-1, 3)
    a = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    b = a + columns + 1
    return places, np.concatenate([np.stack([a, b, b + 1], -1), np.stack([a, b + 1, a + 1], -1)])


def waves(x, most):
    """A random function from -1 to 1 with the period 1."""
    return sum(np.sin(TURN * (k * x + random.random())) / 4 for k in random.integers(1, most, 4))


def tube(count, middle, radius):
    def at(s, t):
        x, y, z = middle(s)
        return x + radius * np.cos(TURN * t), y, z + radius * np.sin(TURN * t)

    return surface(count, at, 8)


def straight(count, start, end, radius):
    return tube(count, lambda s: [a + s * (b - a) for a, b in zip(start, end)], radius)


def joined(meshes):
    starts = np.cumsum([0] + [len(places) for places, _ in meshes])
    return np.concatenate([p for p, _ in meshes]), np.concatenate([c + first for (_, c), first in zip(meshes, starts)])


def pipe(count):
    return tube(count, lambda s: (waves(s / 2, 4), 2 * s, waves(s / 2, 4)), 0.15)


def vessel(count):
    def at(s, t):
        r = (0.6 + 0.3 * waves(s[:, :1], 7)) * np.sqrt(np.sin(np.pi * np.clip(s[:, :1], 0.01, 0.99)))
        return r * np.cos(TURN * t), 2 * s, r * np.sin(TURN * t)

    return surface(count, at)


def ring(count):
    def at(s, t):
        r = 0.3 + 0.05 * waves(s, 40) * waves(t, 20)
        out = 0.7 + r * np.cos(TURN * t)
        return out * np.cos(TURN * s), 1 + out * np.sin(TURN * s), r * np.sin(TURN * t)

    return surface(count, at, 2)


def rock(count):
    def at(s, t):
        level = np.sin(np.pi * t)
        r = 0.8 + level * (0.2 * waves(s, 5) * waves(t, 5) + 0.05 * waves(s, 60) * waves(t, 40))
        return r * level * np.cos(TURN * s), 0.7 + r * np.cos(np.pi * t), r * level * np.sin(TURN * s)

    return surface(count, at, 2)


def boxes(count):
    n = count // 12
    low, size = random.uniform([-1, 0, -1], 1, (n, 3)), random.uniform(0.25, 1, (n, 3)) / n ** (1 / 3)
    cube = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)])
    sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    corners = np.array([[side[0], *pair] for side in sides for pair in (side[1:3], side[2:4])])
    return (low[:, None] + cube * size[:, None]).reshape(-1, 3), (corners + 8 * np.arange(n)[:, None, None]).reshape(-1, 3)


def truss(count):
    n = min(300, count // 64)
    ends = random.integers(-3, 4, (n, 2, 3)) / 3 + [0, 1, 0]
    return joined([straight(count / n, *two, 0.015) for two in ends])


def plant(count):
    n, stem = count // 2, straight(500, [0, 0, 0], [0, 2, 0], 0.03)
    high, around, long = random.uniform(0.2, 2, n), random.uniform(0, TURN, n), random.random(n) ** 0.5
    out = np.stack([np.cos(around), 0 * around + 0.4, np.sin(around)], -1)
    across = np.stack([-np.sin(around), 0 * around, np.cos(around)], -1) / n**0.5
    foot = out * (long * (1.2 - high / 2))[:, None] + high[:, None] * [0, 1, 0]
    tip = foot + 3 * out / n**0.5
    leaves = np.stack([foot - across, foot + across, tip + across, tip - across], 1).reshape(-1, 3)
    return joined([(leaves, ([[0, 1, 2], [0, 2, 3]] + 4 * np.arange(n)[:, None, None]).reshape(-1, 3)), stem])


def write(name, mesh, color):
    """Writes a mesh as a PLY, and gives the lines of the scene that show it; the object's last line follows."""
    places, corners = mesh
    vertices = np.empty(len(places), [("place", "<f4", 3), ("color", "u1", 3)])
    vertices["place"] = places
    vertices["color"] = 255 * (0.75 + 0.25 * np.sin(9 * places.sum(1, keepdims=True))) * color
    faces = np.empty(len(corners), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, corners
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(places)}"]
    header += [f"property float {axis}" for axis in "xyz"] + [f"property uchar {name}" for name in ("red", "green", "blue")]
    header += [f"element face {len(corners)}", "property list uchar int vertex_indices", "end_header", ""]
    (folder / f"{name}.ply").write_bytes("\n".join(header).encode() + vertices.tobytes() + faces.tobytes())
    written.append(len(corners))
    return f'[[geometry]]\nname = "{name}"\nfile = "{name}.ply"\ndraw = "polygons"\n[[object]]\nof = "{name}"\n'


def hill(x, z):
    return 0.5 * np.sin(x / 9) * np.cos(z / 7)


folder.mkdir(exist_ok=True)
written = []
count = max(14, total // 50_000)
sizes = 1000 ** random.random(count)
sizes *= 0.98 * total / sizes.sum()
columns = 2 * int(np.ceil(count**0.5 / 2))  # of places for parts, 4 apart
half = 2 * columns
side = 2 * half + 8
ground = lambda s, t: (side * (s - 0.5), hill(side * (s - 0.5), side * (t - 0.5)), side * (t - 0.5))
scene = write("ground", surface(total // 50, ground), np.array([0.4, 0.45, 0.3]))
for number, size in enumerate(sizes):
    kind = [pipe, vessel, ring, rock, boxes, truss, plant][number % 7]
    scene += write(number, kind(max(100, round(size))), random.uniform(0.3, 1, 3))
    x, z = 4 * (number % columns) + 2 - half, 4 * (number // columns) + 2 - half
    x += 2 if x > 0 else -2  # the street in the middle
    scene += f"transform = {{ scale = {random.uniform(0.8, 1.6)}, translate = [{x}, {hill(x, z)}, {z}], "
    scene += f"rotate = {{ axis = [0, 1, 0], degrees = {random.uniform(0, 360)} }} }}\n"
walk = f"""[sequence]
frames = 60
[camera]
size = [1280, 720]
fov = 50
keys = [
  {{ frame = 0, eye = [0, {half}, {2 * half}], target = [0, 0, 0] }},
  {{ frame = 25, eye = [0, {half / 4}, {half}], target = [0, 0, 0] }},
  {{ frame = 35, eye = [0, 1.8, {0.8 * half}], target = [0, 1.2, 0] }},
  {{ frame = 59, eye = [0, 1.8, {0.2 * half}], target = [0, 1.2, {-half}] }},
]
[method]
name = "blue"
cull = false
"""
(folder / "scene.toml").write_text(walk + scene)
(folder / "walk.toml").write_text('hierarchy = "levels"\n' + walk)
print(f"{folder}/scene.toml: {sum(written)} triangles in {len(written)} parts")
