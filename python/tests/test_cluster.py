"""Pictures of a Dask cluster have the bits of one process."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path
from typing import Any, Callable, Iterator

import numpy as np
import pytest

import splatref as sr
from splatref import cluster

from conftest import ROOT

distributed = pytest.importorskip("distributed")
dask = pytest.importorskip("dask")
CAMERA = sr.Camera(size=(60, 44), fov=40)
# .ci/run sets it in its turn.
SLOW = bool(os.environ.get("SPLATREF_SLOW"))
PROJECT = ("pyramid", "template")
# The files of golden scenes by one process: by scene the picture, the settings that regions need, the bytes.
Wholes = dict[str, tuple[sr.Picture, dict[str, str], bytes]]


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    # Processes, as on several machines. By default a LocalCluster gives up a worker that is away 15 s after it died,
    # even if it died once more meanwhile.
    patient = dask.config.set({"distributed.deploy.lost-worker-timeout": "1h"})
    with patient, _cluster(2) as local, distributed.Client(local) as client:
        yield client


def _cluster(workers: int) -> Any:
    return distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=":0")


@pytest.fixture(scope="module")
def wholes(tmp_path_factory: pytest.TempPathFactory) -> Wholes:
    """Every golden scene as one process draws it."""
    folder, found = tmp_path_factory.mktemp("wholes"), {}
    for path in sorted((ROOT / "golden").glob("*.toml")):
        picture, settings = sr.render(sr.Scene.open(path)), {}
        if picture.method in PROJECT and 'number = "f64"' in picture.text:
            settings = {"number": "f32"}
            picture = sr.render(sr.Scene.open(path), **settings)
        found[str(path)] = picture, settings, _bytes(picture, folder)
    assert len(found) > 50 and {picture.method for picture, _, _ in found.values()} == set(sr.methods.names())
    return found


@pytest.fixture(scope="module")
def some(wholes: Wholes) -> Wholes:
    """One golden scene of each method, or all of them."""
    if SLOW:
        return wholes
    scenes = {whole.method: scene for scene, (whole, _, _) in wholes.items()}
    return {scene: wholes[scene] for scene in scenes.values()}


def _bytes(picture: sr.Picture, folder: Path) -> bytes:
    picture.save(folder / "picture.exr")
    return (folder / "picture.exr").read_bytes()


def _draw_all(client: Any, wholes: Wholes, folder: Path, regions: int) -> None:
    """Draws golden scenes on a cluster, and compares the files with the files of one process."""
    for scene, (whole, settings, expected) in wholes.items():
        if whole.method == "deferred":
            with pytest.raises(ValueError, match="because the pixels of the whole picture select the surfels"):
                cluster.render(scene, client=client, regions=regions)
            continue
        if settings:
            with pytest.raises(ValueError, match="give number f32"):
                cluster.render(scene, client=client, regions=regions)
        joined = cluster.render(scene, client=client, regions=regions, **settings)
        assert _bytes(joined, folder) == expected, (scene, regions)
        assert joined.settings == whole.settings


def test_every_golden_has_the_bytes_of_one_process(client: Any, wholes: Wholes, tmp_path: Path) -> None:
    _draw_all(client, wholes, tmp_path, 7)


@pytest.mark.parametrize("regions", [2, 64])
def test_the_number_of_regions_changes_nothing(client: Any, some: Wholes, regions: int, tmp_path: Path) -> None:
    _draw_all(client, some, tmp_path, regions)


@pytest.mark.parametrize("method", ["ewa", "single-pass", "pyramid"])
def test_a_tiled_folder_is_drawn_as_its_file(client: Any, method: str, program: Path, tmp_path: Path) -> None:
    cloud, folder = tmp_path / "ball.ply", tmp_path / "ball"
    run = lambda *words: subprocess.run([program, *words], check=True, capture_output=True)  # noqa: E731
    run("surfels", ROOT / "golden" / "unoriented.ply", "-o", cloud)
    run("tile", cloud, "-o", folder)
    scene = sr.Scene.open(folder)
    how = {"method": method, "stages": True}
    whole = sr.render(sr.Scene.open(cloud), CAMERA, **how)
    assert scene.count == sr.Scene.open(cloud).count > 0 and whole.tally["drawn"] > 0
    for picture in (sr.render(scene, CAMERA, **how), cluster.render(folder, CAMERA, client=client, regions=3, **how)):
        assert all(np.array_equal(picture[name], whole[name], equal_nan=True) for name in whole)
    assert sr.verify(scene, CAMERA, whole, method=method).right


def test_the_size_of_a_picture_is_known_without_a_surfel(program: Path, tmp_path: Path) -> None:
    folder, blocks = tmp_path / "ball", tmp_path / "ball" / "blocks"
    subprocess.run([program, "tile", ROOT / "golden" / "unoriented.ply", "-o", folder], check=True, capture_output=True)
    whole = sr.Scene.open(folder).camera(CAMERA)
    # Its last byte belongs to the last block of surfels.
    blocks.write_bytes(blocks.read_bytes()[:-1] + b"?")
    scene = sr.Scene._in_parts(folder)
    assert scene.camera(CAMERA)._text == whole._text
    with pytest.raises(ValueError, match="blocks"):
        sr.render(scene, CAMERA)


@pytest.mark.parametrize("workers", [1, 4])
def test_the_number_of_workers_changes_nothing(workers: int, some: Wholes, tmp_path: Path) -> None:
    with _cluster(workers) as local, distributed.Client(local) as client:
        client.wait_for_workers(workers)
        _draw_all(client, some, tmp_path, 7)


class _Meddling:
    """A client that does something before each call of one of its methods."""

    def __init__(self, client: Any, name: str, act: Callable[..., None]) -> None:
        self._client, self._name, self._act = client, name, act

    def __getattr__(self, name: str) -> Any:
        method = getattr(self._client, name)

        def meddled(*values: Any, **named: Any) -> Any:
            self._act(*values)
            return method(*values, **named)

        return meddled if name == self._name else method


def test_a_worker_killed_in_the_middle_changes_nothing(client: Any, wholes: Wholes, tmp_path: Path) -> None:
    killed: list[int] = []

    def kill(futures: Any) -> None:
        nonlocal killed
        client.wait_for_workers(2, timeout=60)
        # The worker that drew the first region dies with it, so that another one draws it again.
        drawn = distributed.wait(futures, return_when="FIRST_COMPLETED").done.pop()
        if drawn.status != "finished":
            return  # the region was refused
        (holder, *_), *_ = client.who_has([drawn]).values()
        killed += client.run(os.getpid, workers=[holder]).values()
        os.kill(killed[-1], signal.SIGKILL)

    # A region drawn alone, and a projection. A worker takes a second to start again.
    few = [str(ROOT / "golden" / f"{name}.toml") for name in ("bjfm19_nodes", "mkc08_hybrid")]
    scenes = wholes if SLOW else {scene: wholes[scene] for scene in few}
    _draw_all(_Meddling(client, "gather", kill), scenes, tmp_path, 7)
    assert len(set(killed)) == sum(whole.method != "deferred" for whole, _, _ in scenes.values())


def test_a_folder_that_is_replaced_meanwhile_gives_no_picture(client: Any, program: Path, tmp_path: Path) -> None:
    folder = tmp_path / "ball"

    def tile(name: str) -> None:
        run = [program, "tile", ROOT / "golden" / name, "-o", folder]
        subprocess.run(run, check=True, capture_output=True)

    tile("unoriented.ply")
    with pytest.raises(ValueError, match="blocks: the file was replaced or truncated") as found:
        cluster.render(folder, CAMERA, client=_Meddling(client, "map", lambda *_: tile("ball.ply")), regions=7)
    assert "\n" not in str(found.value)
    whole, joined = sr.render(sr.Scene.open(folder), CAMERA), cluster.render(folder, CAMERA, client=client, regions=7)
    assert _bytes(joined, tmp_path) == _bytes(whole, tmp_path)


def test_workers_that_do_not_agree_give_no_picture(client: Any, tmp_path: Path) -> None:
    def changing() -> sr.Scene:
        # The first worker that loads the scene makes the file.
        try:
            mark.touch(exist_ok=False)
        except FileExistsError:
            return sr.Scene.open("torus", count=801)
        return sr.Scene.open("torus", count=800)

    class Sharing:
        """The client, but each worker gets every other region; else one worker might draw all of them."""

        def __getattr__(self, name: str) -> Any:
            return getattr(client, name)

        def map(self, draw: Any, regions: list[Any], **more: Any) -> list[Any]:
            # A test before this one may have killed a worker, which is on its way back.
            client.wait_for_workers(2)
            workers = list(client.nthreads())
            turns = (workers[i % len(workers)] for i in range(len(regions)))
            return [client.submit(draw, region, workers=[turn], **more) for region, turn in zip(regions, turns)]

    mark = tmp_path / "loaded"
    with pytest.raises(RuntimeError, match="workers loaded different scenes"):
        cluster.render(changing, CAMERA, client=Sharing(), regions=44)

    def pretend(version: str) -> None:
        cluster.__version__ = version

    one = next(iter(client.nthreads()))
    client.run(pretend, "0.0.1", workers=[one])
    with pytest.raises(RuntimeError, match="a worker has splatref 0.0.1, and the client .*; install the same"):
        cluster.render("torus", CAMERA, client=client, regions=44)
    client.run(pretend, sr.__version__)


def test_a_worker_that_dies_changes_nothing(client: Any, tmp_path: Path) -> None:
    def dying() -> sr.Scene:
        # The first worker that loads the scene ends, as a machine does that fails.
        try:
            mark.touch(exist_ok=False)
        except FileExistsError:
            return sr.Scene.open("torus", count=800)
        os.kill(os.getpid(), signal.SIGKILL)
        raise AssertionError("a killed process goes on")

    mark = tmp_path / "died"
    picture = cluster.render(dying, CAMERA, client=client, regions=7)
    assert mark.exists()
    whole = sr.render(sr.Scene.open("torus", count=800), CAMERA)
    assert all(np.array_equal(picture[name], whole[name], equal_nan=True) for name in whole)


def test_goldens_are_compared_and_damage_is_named(client: Any, tmp_path: Path) -> None:
    names = [path.stem for path in sorted((ROOT / "golden").glob("*.toml"))[:3]]
    for path in (ROOT / "golden").iterdir():
        if path.suffix not in (".toml", ".exr") or path.stem in names:
            (tmp_path / path.name).symlink_to(path)
    assert cluster.golden(tmp_path, client=client) == dict.fromkeys(names)
    (tmp_path / f"{names[0]}.exr").unlink()
    (tmp_path / f"{names[1]}.exr").unlink()
    (tmp_path / f"{names[1]}.exr").symlink_to(ROOT / "golden" / f"{names[2]}.exr")
    said = cluster.golden(tmp_path, client=client)
    assert said[names[2]] is None and "missing" in str(said[names[0]]) and said[names[1]]
    (tmp_path / "empty").mkdir()
    with pytest.raises(ValueError, match="no scene"):
        cluster.golden(tmp_path / "empty", client=client)


def test_what_cannot_be_drawn_is_said(client: Any, tmp_path: Path) -> None:
    scene = sr.Scene.open("sphere", count=100)
    with pytest.raises(TypeError, match="give a file"):
        cluster.render(scene, client=client)  # type: ignore[arg-type]
    with pytest.raises(OSError, match="missing.ply"):
        cluster.render(tmp_path / "missing.ply", client=client)
    with pytest.raises(ValueError, match="deferred"):
        cluster.render("sphere", CAMERA, client=client, method="deferred")
    with pytest.raises(ValueError, match="give number f32"):
        cluster.render("sphere", CAMERA, client=client, method="pyramid", number="f64")
    with pytest.raises(ValueError, match="regions=0"):
        cluster.render("sphere", CAMERA, client=client, regions=0)


def test_a_region_is_a_crop_of_the_whole(tmp_path: Path) -> None:
    scene = sr.Scene.open("torus", count=800)
    whole, part = (sr.render(scene, CAMERA, region=region) for region in (None, (5, 7, 40, 31)))
    assert part.region == (5, 7, 40, 31) and whole.region == (0, 0, 60, 44) and part.size == (35, 24)
    assert all(np.array_equal(part[name], whole[name][7:31, 5:40], equal_nan=True) for name in whole)
    part = sr.render(scene, CAMERA, method="pyramid", region=(5, 7, 40, 31))
    whole = sr.render(scene, CAMERA, method="pyramid", stages=True)
    own = [name for name in part if name.startswith("projection")]
    assert len(own) > 7 and set(part) == set(own) and "[projection]" in part.text
    assert all(np.array_equal(part[name], whole[name][7:31, 5:40]) for name in own)
    for region, what in (((0, 0, 61, 44), "61"), ((5, 5, 5, 9), "no pixel"), ((1, 2, 3), "give")):
        with pytest.raises(ValueError, match=what):
            sr.render(scene, CAMERA, region=region)  # type: ignore[arg-type]
