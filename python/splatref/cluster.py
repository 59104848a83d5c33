"""Draw a picture, study a scene, or test a folder of goldens on a Dask cluster, with the bits of one machine.

    from dask.distributed import Client
    client = Client()                                   # or the address of a scheduler
    picture = sr.cluster.render("city.ply", camera, client=client, method="ewa")

Regions of a picture and candidates of a study do not depend on each other, so that Dask may draw them in any
order, and draws them again if a worker dies. Workers need this version of splatref, and the files of the scene under the same names.
"""

from __future__ import annotations

import importlib
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
from ._study import Study, from_parts, load_candidates
from ._text import choices

Source = Union[Path, Callable[[], Scene]]

_DIFFERENT = "workers loaded different scenes: a file changed, or is another one on another machine"


@dataclass(frozen=True)
class _Job:
    """What every worker needs."""

    token: str
    version: str
    source: Source
    camera: Optional[AnyCamera]
    chosen: Any
    truth: Optional[Source] = None


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
_loaded: Optional[tuple[str, Any]] = None
# Held while a candidate of a study is measured.
_turn = threading.Lock()


def _check(version: str) -> None:
    if version != __version__:
        raise RuntimeError(f"a worker has splatref {__version__}, and the client {version}; install the same")


def _once(job: _Job, make: Callable[[_Job], Any]) -> Any:
    """What `make` loads, once in this process for each call of `render` or `study`."""
    global _loaded
    _check(job.version)
    with _lock:
        if _loaded is None or _loaded[0] != job.token:
            _loaded = (job.token, make(job))
        return _loaded[1]


def _scene(job: _Job) -> Scene:
    scene: Scene = _once(job, lambda job: job.source() if callable(job.source) else Scene._in_parts(job.source))
    return scene


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


def _portable(name: str, source: Source) -> Source:
    """A scene that a worker can load."""
    if isinstance(source, Scene):
        raise TypeError(f"{name}: a Scene is in the memory of this process; give a file, or a function that makes it")
    return source if callable(source) else os.fspath(source)


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
    source = _portable("scene", scene)
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
            raise RuntimeError(_DIFFERENT)
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


def study(
    scene: Source,
    camera: Optional[AnyCamera] = None,
    *,
    client: Any,
    method: Optional[str] = None,
    truth: Optional[Source] = None,
    frame: Optional[int] = None,
    **settings: object,
) -> Study:
    """Studies a scene on a Dask cluster: `splatref.study`, a candidate on a worker.

    scene, truth: the name of a file or shape, or a function that opens the scene on a worker.
    client: a `dask.distributed.Client`.

    The other arguments are those of `splatref.study`, and so are the candidates and their errors, bit for bit.
    Each worker loads the scene and draws the truth once. It measures one candidate at a time, with all threads
    of the worker, and takes all its times in a row. `Candidate.machine` names the machine: compare only times
    of one kind of machine. Raises `RuntimeError` if a worker has another version of splatref, or if workers
    loaded different scenes.
    """
    other = None if truth is None else _portable("truth", truth)
    chosen = choices("study", method, settings, frame)
    job = _Job(uuid.uuid4().hex, __version__, _portable("scene", scene), camera, chosen, other)
    candidates, left_out = client.submit(_listed, job, pure=False).result()
    parts = _in_turn(client, job, len(candidates))
    if any(part[0] != parts[0][0] for part in parts):
        raise RuntimeError(_DIFFERENT)
    return from_parts(candidates, left_out, parts)


def _in_turn(client: Any, job: _Job, count: int) -> list[Any]:
    """Measures the candidates. A worker gets the next one when it has measured the one before."""
    parts: list[Any] = [None] * count
    waiting, begun = iter(range(count)), dict[Any, tuple[int, Optional[str]]]()
    running = importlib.import_module("distributed").as_completed(loop=client.loop)

    def begin() -> None:
        busy = [address for _, address in begun.values()]
        for address in list(client.nthreads()) or [None]:
            index = next(waiting, None) if address not in busy else None
            if index is not None:
                at = None if address is None else [address]
                # Another worker takes it over if this one dies.
                future = client.submit(_measured, index, job, workers=at, allow_other_workers=at is not None, pure=False)
                begun[future] = index, address
                running.add(future)

    try:
        begin()
        for future in running:
            parts[begun.pop(future)[0]] = future.result()
            begin()
        return parts
    finally:
        client.cancel(list(begun))


def _how() -> How:
    """All threads of this worker."""
    return How(importlib.import_module("distributed").get_worker().state.nthreads, 32, None)


def _candidates(job: _Job) -> Any:
    """The loaded candidates of a study."""
    source = job.source() if callable(job.source) else job.source
    truth = job.truth() if callable(job.truth) else job.truth
    return load_candidates(_how(), source, job.camera, job.chosen, truth)


def _listed(job: _Job) -> tuple[list[tuple[str, str]], list[tuple[str, str]]]:
    loaded = _once(job, _candidates)
    return loaded.candidates, loaded.left_out


def _measured(index: int, job: _Job) -> Any:
    # Another candidate may come from another study, or from a worker that died. Each would slow down the other.
    with _turn:
        return _once(job, _candidates).run(_how(), [index])


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


__all__ = ["golden", "render", "study"]
