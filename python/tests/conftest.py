"""What several tests need: a small scene, the repository, the program if it was built, and Ctrl-C."""

from __future__ import annotations

import os
import signal
from pathlib import Path
from typing import Iterator

import numpy as np
import pytest

import splatref as sr

pytest_plugins = ["pytester"]
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def program() -> Path:
    """The program `splatref`: SPLATREF_PROGRAM, or what cargo built last."""
    named = os.environ.get("SPLATREF_PROGRAM")
    found = [Path(named)] if named else [ROOT / "target" / kind / "splatref" for kind in ("release", "debug")]
    built = [path for path in found if path.exists()]
    if not built:
        pytest.skip("the program was not built: cargo build --release")
    return max(built, key=lambda path: path.stat().st_mtime)


@pytest.fixture(scope="session")
def scene() -> sr.Scene:
    return sr.Scene.open("sphere", count=2000)


@pytest.fixture(scope="session")
def camera() -> sr.Camera:
    return sr.Camera(size=(64, 48))


@pytest.fixture(scope="session")
def picture(scene: sr.Scene, camera: sr.Camera) -> sr.Picture:
    return sr.render(scene, camera, stages=True)


def sphere(count: int = 500) -> dict[str, np.ndarray]:
    """Arrays of a sphere of radius 1."""
    i = np.arange(count) + 0.5
    z = 1 - 2 * i / count
    turn = i * np.pi * (1 + 5**0.5)
    ring = np.sqrt(1 - z * z)
    p = np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=1).astype(np.float32)
    radii = np.full(count, 2.5 / count**0.5, np.float32)
    return {"positions": p, "normals": p.copy(), "radii": radii}


@pytest.fixture(autouse=True)
def heeds_ctrl_c() -> Iterator[None]:
    """Python heeds Ctrl-C in these tests, even where a shell started it in the background, which ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
