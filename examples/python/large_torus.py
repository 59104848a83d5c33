"""Writes a torus of any number of surfels as a PLY, in memory that does not grow: scenes to try `splatref tile` with.

    python examples/python/large_torus.py 300000000 large.ply

A surfel takes 28 bytes: position, normal and radius. The torus has the radii 1 and 0.4. Neighbours in the file are far apart
in space.
"""

import sys

import numpy as np

count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
name = sys.argv[2] if len(sys.argv) > 2 else "large.ply"
PART = 1 << 20  # surfels at a time
FIELDS = ["x", "y", "z", "nx", "ny", "nz", "radius"]

# The radius at which discs of this number cover the torus twice.
radius = (2 * 4 * np.pi**2 * 0.4 / (np.pi * count)) ** 0.5
with open(name, "wb") as file:
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {count}"]
    header += [f"property float {field}" for field in FIELDS] + ["end_header", ""]
    file.write("\n".join(header).encode())
    for start in range(0, count, PART):
        i = np.arange(start, min(count, start + PART), dtype=np.float64)
        # Powers of the plastic number spread points evenly over both angles (Roberts' R2 sequence).
        around, across = 2 * np.pi * (i * 0.7548776662466927 % 1), 2 * np.pi * (i * 0.5698402909980532 % 1)
        outward = np.cos(across)
        normal = np.stack([np.cos(around) * outward, np.sin(across), np.sin(around) * outward])
        ring = np.stack([np.cos(around), np.zeros_like(around), np.sin(around)])
        rows = np.concatenate([ring + 0.4 * normal, normal, np.full((1, len(i)), radius)])
        file.write(np.ascontiguousarray(rows.T, dtype="<f4").tobytes())
print(f"{name}: {count} surfels, {7 * 4 * count / 2**20:.1f} MiB")
