"""Prints the references of src/compare/metrics/outline.rs (pip install scikit-image==0.26.0)."""
import numpy as np
from skimage.measure import perimeter_crofton

y, x = np.mgrid[0:48, 0:64]
inside = (x > 0) & (y > 0) & (x < 63) & (y < 47)
for name, covered in [
    ("disc", (x - 30) ** 2 + (y - 22) ** 2 < 300),
    ("rough", (x * x * 7 + y * 13 + x * y * 3) % 256 < 100),
    ("slanted", 3 * x + 7 * y < 200),
]:
    print(name, repr(float(perimeter_crofton(covered & inside, directions=4))))
