"""Long calls: threads, Ctrl-C, progress, and panics."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import splatref as sr
from splatref import _splatref

HOW = SimpleNamespace(threads=2, tile=32, progress=None)


def test_ctrl_c_stops_a_call() -> None:
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    start = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        _splatref.fail(HOW, True)
    assert time.monotonic() - start < 5


def test_ctrl_c_in_a_long_call_leaves_no_file(tmp_path: Path) -> None:
    code = """
import os, signal, splatref as sr, threading, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
scene = sr.Scene.open("cluster", count=20000)
threading.Timer(0.4, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    while True:
        sr.render(scene, sr.Camera(size=(400, 300)), stages=True).save("a.exr")
except KeyboardInterrupt:
    print("stopped")
sr.render(scene, sr.Camera(size=(32, 24)))
"""
    said = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert said.stdout == "stopped\n" and said.returncode == 0, said.stderr
    assert {path.name for path in tmp_path.iterdir()} <= {"a.exr"}
    if (tmp_path / "a.exr").exists():
        sr.read(tmp_path / "a.exr")


def test_a_panic_is_a_runtime_error_that_says_it_is_a_bug() -> None:
    with pytest.raises(RuntimeError, match="a bug in splatref, please report it: this is a test"):
        _splatref.fail(HOW, False)


def test_two_threads_call_at_once(scene: sr.Scene, camera: sr.Camera, picture: sr.Picture) -> None:
    found: list[sr.Picture] = []

    def work() -> None:
        for method in ("ewa", "single-pass", "ewa"):
            found.append(sr.render(scene, camera, method=method, stages=True))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    ewa = [one for one in found if one.method == "ewa"]
    assert len(ewa) == 8 and all(sr.compare(picture, one).equal for one in ewa)


def test_other_threads_run_during_a_call() -> None:
    count, stop = 0, threading.Event()

    def spin() -> None:
        nonlocal count
        while not stop.is_set():
            count += 1

    thread = threading.Thread(target=spin)
    thread.start()
    scene = sr.Scene.open("cluster", count=5000)
    before = count
    sr.render(scene, sr.Camera(size=(320, 240)), stages=True)
    assert count > before
    stop.set()
    thread.join()


def test_a_call_in_another_thread_than_the_first_is_not_interrupted(scene: sr.Scene, camera: sr.Camera) -> None:
    found: list[object] = []
    thread = threading.Thread(target=lambda: found.append(sr.render(scene, camera)))
    thread.start()
    thread.join()
    assert isinstance(found[0], sr.Picture)


def test_progress_is_told_and_its_exception_is_raised() -> None:
    told: list[tuple[str, int, int]] = []

    def tell(step: str, done: int, of: int) -> None:
        told.append((step, done, of))
        if len(told) > 3:
            raise OverflowError("enough")

    with pytest.raises(OverflowError, match="enough"):
        _splatref.fail(SimpleNamespace(threads=2, tile=32, progress=tell), True)
    assert any(step == "waiting" and done > 0 for step, done, _ in told)


def test_a_bar_appears_and_goes(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("tqdm")
    from splatref import _call

    monkeypatch.setattr(_call, "_PATIENCE", 0.0)
    with _call.calling(True) as how:
        assert how.progress is not None
        how.progress("grouping", 3, 10)
    assert "grouping" in capsys.readouterr().err
    with _call.calling(None) as how:
        assert how.progress is None, "no terminal"


@pytest.mark.parametrize("threads, tile", [(1, 8), (2, 64), (3, 16)])
def test_threads_and_tiles_change_no_bit(
    threads: int, tile: int, scene: sr.Scene, camera: sr.Camera, picture: sr.Picture
) -> None:
    sr.use(threads=threads, tile=tile)
    try:
        assert sr.compare(picture, sr.render(scene, camera, stages=True)).equal
    finally:
        sr.use(threads=0, tile=32)
    for wrong in ({"threads": -1}, {"threads": 5000}, {"tile": 12}):
        with pytest.raises(ValueError):
            sr.use(**wrong)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_forked_process_has_threads_of_its_own(scene: sr.Scene, camera: sr.Camera, picture: sr.Picture) -> None:
    code = """
import os, splatref as sr
scene, camera = sr.Scene.open("sphere", count=500), sr.Camera(size=(32, 24))
first = sr.render(scene, camera)
child = os.fork()
if child == 0:
    os._exit(0 if sr.compare(first, sr.render(scene, camera)).equal else 1)
assert os.waitpid(child, 0)[1] == 0
"""
    subprocess.run([sys.executable, "-W", "ignore", "-c", code], check=True, timeout=60)


def test_state_goes_from_frame_to_frame() -> None:
    scene = sr.Scene.open("sphere", count=2000)
    cameras = [sr.Camera(eye=(x, 0, 4), target=(0, 0, 0), size=(48, 36)) for x in (0.0, 0.2, 0.4)]
    together = sr.render(scene, cameras, method="deferred")
    state, alone = None, []
    for camera in cameras:
        alone.append(sr.render(scene, camera, method="deferred", state=state))
        state = alone[-1].state
    assert all(sr.compare(a, b).equal for a, b in zip(together, alone))
    assert sr.render(scene, cameras[0]).state is None
    fresh = sr.render(scene, cameras[2], method="deferred")
    assert np.array_equal(fresh["Z"].shape, alone[2]["Z"].shape)
