"""splatref: the ground truth for point-splatting renderers. numpy in, pictures and verdicts out.

>>> import splatref as sr
>>> scene = sr.Scene.open("sphere", count=2000)
>>> picture = sr.render(scene, sr.Camera(size=(64, 48)), stages=True)
>>> picture["Z"].shape
(48, 64)
>>> sr.verify(scene, sr.Camera(size=(64, 48)), picture).right
True

- `Scene`, `Camera`: what is drawn, from files or arrays, and from where.
- `render`, `explain`, `truth`, `read`: pictures, as arrays by name.
- `project`: projected splats, as structured arrays.
- `verify`: whether your renderer's planes are right, and the likely mistake.
- `study`: the error and the time of every method and setting.
- `compare`, `metrics`: equality of planes, and errors that rank methods.
- `surfels`: orders of points. `laws`: compositing laws against your function.
- `cluster`: pictures, studies and goldens on a Dask cluster.
- `methods`: methods, settings and planes by name. `testing`: assertions and fixtures for pytest.
"""

from __future__ import annotations

from . import cluster, laws, methods, metrics, surfels, testing
from ._call import use
from ._compare import Comparison, compare, sha256
from ._picture import Picture, Planes, explain, read, render, truth
from ._records import project
from ._scene import Camera, ResolvedCamera, Scene
from ._splatref import __version__
from ._study import Candidate, Study, study
from ._verdict import DOUBTS, Stage, Verdict, Worst, verify

NO_ID = 0xFFFF_FFFF
"""The id of a pixel where nothing is, in planes of ids."""

__all__ = [
    "Camera",
    "Candidate",
    "Comparison",
    "DOUBTS",
    "NO_ID",
    "Picture",
    "Planes",
    "ResolvedCamera",
    "Scene",
    "Stage",
    "Study",
    "Verdict",
    "Worst",
    "__version__",
    "cluster",
    "compare",
    "explain",
    "laws",
    "methods",
    "metrics",
    "project",
    "read",
    "render",
    "sha256",
    "study",
    "surfels",
    "testing",
    "truth",
    "use",
    "verify",
]
