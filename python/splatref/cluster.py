"""Draw a picture, or test a folder of goldens, on the workers of a Dask cluster, with the bits of one machine.

    from dask.distributed import Client
    client = Client()                                   # or the address of a scheduler
    picture = sr.cluster.render("city.ply", camera, client=client, method="ewa")

Regions of a picture do not depend on each other, so that Dask may draw them in any order, and draws them
again if a worker dies. Workers need this version of splatref, and the files of the scene under the same names.
"""

from __future__ import annotations

import functools
import os
import threading
import time
import uuid
from dataclasses import dataclass
from typing import Any, Callable, Iterator, Optional, Union

import numpy as np

from . import _splatref
from ._call import How, calling
from ._compare import compare
from ._picture import Picture, listed, read, render_one
from ._scene import AnyCamera, Path, Scene
from ._splatref import __version__
from ._text import choices

Source = Union[Path, Callable[[], Scene]]


@dataclass(frozen=True)
class _Job:
    """What every worker needs."""

    token: str
    version: str
    source: Callable[[], Scene]
    camera: Optional[AnyCamera]
    chosen: Any


@dataclass(frozen=True)
class _Part:
    """What a worker sends back. A `Picture` reads it as it reads what Rust drew."""

    planes: dict[str, Any]
    window: tuple[list[int], list[int]]
    said: str
    camera: dict[str, Any]
    method: str
    settings: list[tuple[str, str]]
    number: str
    compression: str
    times: list[tuple[str, float]]
    tally: list[tuple[str, int]]
    projects: bool
    state: None = None

    def text(self, _: object) -> str:
        return self.said


_lock = threading.Lock()
_loaded: Optional[tuple[str, Scene]] = None


def _check(version: str) -> None:
    if version != __version__:
        raise RuntimeError(f"a worker has splatref {__version__}, and the client {version}; install the same")


def _scene(job: _Job) -> Scene:
    """The scene, loaded once in this process for each call of `render`."""
    global _loaded
    _check(job.version)
    with _lock:
        if _loaded is None or _loaded[0] != job.token:
            _loaded = (job.token, job.source())
        return _loaded[1]


def _size(job: _Job) -> tuple[int, int]:
    scene = _scene(job)
    return scene.camera(job.camera, frame=job.chosen.frame).size


def _draw(region: list[int], job: _Job) -> _Part:
    # One thread, because Dask gives a worker as many regions as it has threads.
    how = How(1, 32, None)
    planes, drawn = render_one(how, _scene(job), job.camera, job.chosen, region)
    return _Part(
        dict(planes), drawn.window, drawn.text(how), drawn.camera, drawn.method, drawn.settings, drawn.number,
        drawn.compression, drawn.times, drawn.tally, drawn.projects,
    )  # fmt: skip


def _bands(size: tuple[int, int], count: int) -> Iterator[list[int]]:
    width, height = size
    ends = [height * i // count for i in range(count + 1)]
    return ([0, y0, width, y1] for y0, y1 in zip(ends, ends[1:]))


def render(
    scene: Source,
    camera: Optional[AnyCamera] = None,
    *,
    client: Any,
    regions: Optional[int] = None,
    method: Optional[str] = None,
    frame: Optional[int] = None,
    **settings: object,
) -> Picture:
    """Renders a scene on a Dask cluster: `splatref.render`, in bands of rows.

    scene: the name of a file or shape, as for `Scene.open`, or a function that makes the scene on a worker.
    client: a `dask.distributed.Client`.
    regions: how many bands; four for each thread of the workers if absent, and at most one for each row.

    By the methods pyramid and template, the workers draw the projection, and this process the other stages.
    The other arguments are those of `splatref.render`, and so are the errors. Raises `RuntimeError` if a
    worker has another version of splatref, or if workers loaded different scenes. The times of the picture
    are sums over all workers.
    """
    if isinstance(scene, Scene):
        raise TypeError("scene: a Scene is in the memory of this process; give a file, or a function that makes it")
    source = scene if callable(scene) else functools.partial(Scene.open, os.fspath(scene))
    job = _Job(uuid.uuid4().hex, __version__, source, camera, choices("render", method, settings, frame))
    size = client.submit(_size, job, pure=False).result()
    count = 4 * max(1, sum(client.nthreads().values())) if regions is None else regions
    if count < 1:
        raise ValueError(f"regions={count}; give at least 1")
    futures = client.map(_draw, list(_bands(size, min(count, size[1]))), job=job, pure=False)
    try:
        return _joined(size, client.gather(futures))
    finally:
        client.cancel(futures)


def _joined(size: tuple[int, int], parts: list[_Part]) -> Picture:
    first, (width, height) = parts[0], size
    whole = {name: np.empty((height, *plane.shape[1:]), plane.dtype) for name, plane in first.planes.items()}
    times: list[tuple[str, float]] = []
    for part in parts:
        if part.said != first.said or part.planes.keys() != whole.keys():
            raise RuntimeError("workers loaded different scenes: a file changed, or is another one on another machine")
        _, y0, _, y1 = part.window[0]
        for name, plane in part.planes.items():
            whole[name][y0:y1] = plane
        times += part.times
    said = first.said
    if first.projects:
        # The stages after the projection need the whole picture, and nothing of the scene but what the text says.
        with calling(False) as how:
            start = time.perf_counter()
            planes, said = _splatref.finish(how, listed(whole), said)
            times.append(("finish", time.perf_counter() - start))
        whole = dict(planes)
    joined = _Part(
        {}, ([0, 0, width, height], [width, height]), said, first.camera, first.method, first.settings,
        first.number, first.compression, times, first.tally, False,
    )  # fmt: skip
    return Picture(whole, joined)


def golden(folder: Path, *, client: Any) -> dict[str, Optional[str]]:
    """Renders every scene of a folder on a Dask cluster, and compares each with its stored picture.

    As the command `golden`: NAME.toml belongs to NAME.exr; of a sequence the last frame counts. Returns by
    name `None` if every bit is equal, else what differs, in words. Raises `ValueError` if there is no scene.

    client: a `dask.distributed.Client`, whose workers see the folder under this name.
    """
    folder = os.path.abspath(os.fspath(folder))
    stems = {os.path.splitext(name)[0] for name in os.listdir(folder) if name.endswith((".toml", ".exr"))}
    names = sorted(stems)
    if not names:
        raise ValueError(f"{folder}: no scene; give a folder that holds NAME.toml and NAME.exr")
    futures = client.map(_compared, [os.path.join(folder, name) for name in names], version=__version__, pure=False)
    try:
        return dict(zip(names, client.gather(futures)))
    finally:
        client.cancel(futures)


def _compared(stem: str, version: str) -> Optional[str]:
    _check(version)
    for kind in (".toml", ".exr"):
        if not os.path.exists(stem + kind):
            return f"{stem}{kind} is missing"
    scene, how, state = Scene.open(stem + ".toml"), How(1, 32, None), None
    for frame in range(scene.frames):
        planes, drawn = render_one(how, scene, None, choices("render", None, {}, frame), state=state)
        state = drawn.state
    comparison = compare(read(stem + ".exr"), dict(planes))
    return None if comparison.equal else str(comparison)


__all__ = ["golden", "render"]
