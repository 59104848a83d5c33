"""Pictures of a Dask cluster have the bits of one process."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path
from typing import Any, Iterator

import numpy as np
import pytest

import splatref as sr
from splatref import cluster

from conftest import ROOT

distributed = pytest.importorskip("distributed")
CAMERA = sr.Camera(size=(60, 44), fov=40)


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    # Processes, as on several machines.
    with _cluster(2) as local, distributed.Client(local) as client:
        yield client


def _cluster(workers: int) -> Any:
    return distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=":0")


@pytest.mark.parametrize("method", ["ewa", "peeling", "blue", "pyramid", "template"])
@pytest.mark.parametrize("regions", [1, 7, 64])
def test_every_division_has_the_bytes_of_the_whole(client: Any, method: str, regions: int, tmp_path: Path) -> None:
    whole = sr.render(sr.Scene.open("torus", count=800), CAMERA, method=method, stages=True)
    joined = cluster.render(
        lambda: sr.Scene.open("torus", count=800), CAMERA, client=client, regions=regions, method=method, stages=True
    )
    for picture, name in ((whole, "whole"), (joined, "joined")):
        picture.save(tmp_path / f"{name}.exr")
    assert (tmp_path / "whole.exr").read_bytes() == (tmp_path / "joined.exr").read_bytes()
    assert joined.tally["drawn"] > 0 and joined.settings == whole.settings


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
def test_the_number_of_workers_changes_nothing(workers: int) -> None:
    def torus() -> sr.Scene:
        return sr.Scene.open("torus", count=800)

    whole = sr.render(torus(), CAMERA)
    with _cluster(workers) as local, distributed.Client(local) as client:
        client.wait_for_workers(workers)
        picture = cluster.render(torus, CAMERA, client=client, regions=7)
    assert all(np.array_equal(picture[name], whole[name], equal_nan=True) for name in whole)


def test_a_worker_that_dies_changes_nothing(client: Any, tmp_path: Path) -> None:
    def dying() -> sr.Scene:
        # The first worker that loads the scene ends, as a machine does that fails.
        if not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return sr.Scene.open("torus", count=800)

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
    job = cluster._Job("", "0.0.0", lambda: scene, None, None)
    with pytest.raises(RuntimeError, match="install the same"):
        cluster._scene(job)


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
