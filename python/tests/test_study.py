"""Studies have the candidates and the errors of the command `splatref study`, here and on a Dask cluster."""

from __future__ import annotations

import json
import os
import signal
import subprocess
from pathlib import Path
from typing import Any, Iterator

import pytest

import splatref as sr
from splatref import cluster

from conftest import ROOT

CAMERA = sr.Camera(size=(48, 32), fov=40)
OPTIONS = ["--size", "48x32", "--fov", "40", "--method", "template"]


def torus() -> sr.Scene:
    return sr.Scene.open("torus", count=400)


@pytest.fixture(scope="module", params=[1, 2], ids=["one worker", "two workers"])
def client(request: pytest.FixtureRequest) -> Iterator[Any]:
    distributed = pytest.importorskip("distributed")
    # One worker has two threads, so that Dask gives it two candidates at once.
    workers = {"n_workers": request.param, "threads_per_worker": 3 - request.param}
    with distributed.LocalCluster(**workers, dashboard_address=None) as local:
        with distributed.Client(local) as client:
            yield client


@pytest.fixture(scope="module")
def known(program: Path, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """What the program says of the torus."""
    return of_program(program, tmp_path_factory.mktemp("study"), "torus", "--count", "400", "--cull=off", *OPTIONS)


def of_program(program: Path, folder: Path, *arguments: object) -> Any:
    command = [program, "study", *arguments, "-o", folder / "study"]
    subprocess.run(list(map(str, command)), cwd=folder, check=True, capture_output=True)
    return json.loads((folder / "study" / "study.json").read_text())


def bits(errors: dict[str, float]) -> dict[str, str]:
    return {name: value.hex() for name, value in errors.items()}


def assert_same(found: sr.Study, known: Any) -> None:
    assert found.truth == known["of"]["truth"]
    assert [one.options for one in found.candidates] == [one["options"] for one in known["candidates"]]
    for one, other in zip(found.candidates, known["candidates"]):
        assert bits(one.errors) == bits(other["measured"]["figures"]), one.options
        assert (one.method, one.surfels) == (other["method"], other["measured"]["surfels"])
        # Emulated formats have no times in either.
        assert bool(one.times) == bool(other["times"]) and all(time > 0 for time in one.times)
        assert one.machine.endswith(" threads")


def test_a_study_is_that_of_the_program(known: Any) -> None:
    found = sr.study(torus(), CAMERA, method="template", cull=False)
    assert_same(found, known)
    assert len(found.candidates) > 10 and found.left_out == []


def test_a_study_on_a_cluster_is_that_of_the_program(client: Any, known: Any, tmp_path: Path) -> None:
    def opening() -> sr.Scene:
        with loads.open("a") as file:
            file.write(f"{os.getpid()}\n")
        return torus()

    loads = tmp_path / "loads"
    found = cluster.study(opening, CAMERA, client=client, method="template", cull=False)
    assert_same(found, known)
    processes = loads.read_text().split()
    assert len(processes) == len(set(processes)) <= len(client.nthreads()), "each worker loads once"
    threads = next(iter(client.nthreads().values()))
    assert {one.machine.rsplit(", ", 1)[1] for one in found.candidates} == {f"{threads} threads"}


def test_the_truth_may_be_another_scene(client: Any, program: Path, tmp_path: Path) -> None:
    points = ROOT / "golden" / "blue.ply"
    known = of_program(program, tmp_path, points, "--truth", "sphere", *OPTIONS)
    assert_same(cluster.study(points, CAMERA, client=client, method="template", truth="sphere"), known)
    assert_same(sr.study(points, CAMERA, method="template", truth=sr.Scene.open("sphere", count=9)), known)
    assert known["of"]["truth"].startswith("the exact surface")


def test_methods_that_cannot_draw_the_scene_are_left_out_with_the_reason(client: Any) -> None:
    found = cluster.study(lambda: sr.Scene.open("tree", count=50), sr.Camera(size=(24, 16)), client=client)
    drawing = {one.method for one in found.candidates}
    left_out = dict(found.left_out)
    assert drawing and not drawing & set(left_out) and drawing | set(left_out) == set(sr.methods.names())
    assert left_out["ewa"].endswith("does not draw them; use method pyramid")


# The second load is that of a worker that measures; the first lists the candidates.
@pytest.mark.parametrize("client, last", [(1, 1), (2, 1), (2, 2)], indirect=["client"])
def test_a_worker_that_dies_changes_no_error(client: Any, last: int, known: Any, tmp_path: Path) -> None:
    def dying() -> sr.Scene:
        with loads.open("a") as file:
            file.write("a load\n")
        if len(loads.read_text().splitlines()) == last:
            os.kill(os.getpid(), signal.SIGKILL)
        return torus()

    loads = tmp_path / "loads"
    assert_same(cluster.study(dying, CAMERA, client=client, method="template", cull=False), known)
    # The other worker may measure everything before the dead one is there again.
    assert len(loads.read_text().splitlines()) >= last


def test_what_cannot_be_studied_is_said(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    for study in (sr.study, lambda *of, **more: cluster.study(*of, client=client, **more)):
        with pytest.raises(FileNotFoundError, match="missing.ply"):
            study("missing.ply")
        with pytest.raises(FileNotFoundError, match="missing.ply"):
            study("torus", CAMERA, method="template", truth="missing.ply")
        with pytest.raises(ValueError, match="method `best`; give one of"):
            study("torus", CAMERA, method="best")
        with pytest.raises(TypeError, match="no setting 'best'"):
            study("torus", CAMERA, best=1)
    with pytest.raises(ValueError, match="came from arrays"):
        sr.study(sr.Scene([[0, 0, 0]], normals=[[0, 0, 1]], radii=1), CAMERA)
    with pytest.raises(TypeError, match="scene: int"):
        sr.study(3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="truth: a Scene is in the memory of this process"):
        cluster.study("torus", CAMERA, client=client, truth=torus())  # type: ignore[arg-type]
    monkeypatch.setattr(cluster, "__version__", "0.0.0")
    with pytest.raises(RuntimeError, match="a worker has splatref .*, and the client 0.0.0; install the same"):
        cluster.study("torus", CAMERA, client=client)


@pytest.mark.parametrize("client", [2], indirect=True)
def test_workers_with_different_scenes_are_refused(client: Any, tmp_path: Path) -> None:
    def differing() -> sr.Scene:
        try:
            mark.touch(exist_ok=False)
        except FileExistsError:
            return sr.Scene.open("torus", count=401)
        return torus()

    mark = tmp_path / "first"
    with pytest.raises(RuntimeError, match="workers loaded different scenes"):
        cluster.study(differing, CAMERA, client=client, method="template")


def test_ctrl_c_ends_a_study(client: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    person, begun, pressed = os.getpid(), tmp_path / "begun", tmp_path / "pressed"

    def measuring(*_: object) -> None:
        with begun.open("a") as file:
            file.write("a candidate\n")
        try:
            pressed.touch(exist_ok=False)
        except FileExistsError:
            return
        os.kill(person, signal.SIGINT)

    monkeypatch.setattr(cluster, "_measured", measuring)
    with pytest.raises(KeyboardInterrupt):
        cluster.study(torus, CAMERA, client=client, method="template")
    # A worker may end its first before the signal comes, and no worker has a candidate waiting.
    assert len(begun.read_text().splitlines()) <= 2 * len(client.nthreads())


def test_a_worker_measures_one_candidate_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    alone = []

    class Loaded:
        def run(self, *_: object) -> None:
            alone.append(cluster._turn.locked())

    monkeypatch.setattr(cluster, "_how", lambda: None)
    monkeypatch.setattr(cluster, "_loaded", ("token", Loaded()))
    job = cluster._Job("token", sr.__version__, "torus", None, None)
    cluster._measured(0, job)
    assert alone == [True] and not cluster._turn.locked()


def candidate(name: str, times: tuple[float, ...], machine: str = "a", **errors: float) -> sr.Candidate:
    return sr.Candidate(name, "ewa", 1, errors, times, machine)


def test_the_front_is_what_nothing_beats() -> None:
    fast = candidate("fast", (3, 1, 2), rmse=0.5, ssim=0.9)
    good = candidate("good", (9, 4), rmse=0.1, ssim=0.2)
    beaten = candidate("beaten", (9,), rmse=0.2, ssim=0.1)
    untimed = candidate("untimed", (), "b", rmse=0.0, ssim=1.0)
    study = sr.Study([beaten, good, untimed, fast], [], "")
    assert (fast.time, good.time, untimed.time) == (2, 9, None)
    assert study.front() == [fast, good]
    assert study.front("ssim") == [fast], "a larger SSIM is better"
    assert study.front("psnr") == [], "nobody has this figure"
    with pytest.raises(ValueError, match="metric beauty; give one of rmse, "):
        study.front("beauty")
    other = candidate("other", (1,), "b", rmse=0.1)
    with pytest.raises(ValueError, match="times of several machines cannot be compared: a; b"):
        sr.Study([fast, other], [], "").front()
