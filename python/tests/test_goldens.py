"""The planes of every golden through Python are those of the program, to the bit."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

import splatref as sr
from conftest import ROOT


def test_every_golden_has_the_same_hash(program: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names = sorted({path.stem for path in (ROOT / "golden").glob("*.toml")})
    # As `splatref golden` does: a picture without a scene is a case too, and there is none.
    assert names == sorted({path.stem for path in (ROOT / "golden").glob("*.exr")})
    pictures = {}
    monkeypatch.chdir(ROOT)
    for name in names:
        scene, state = sr.Scene.open(f"golden/{name}.toml"), None
        for frame in range(scene.frames):
            pictures[name] = sr.render(scene, frame=frame, state=state)
            state = pictures[name].state
        stored = sr.read(f"golden/{name}.exr")
        assert sr.compare(stored, pictures[name]).equal, name
    ours = sr.sha256(pictures)
    stored_pictures = {name: sr.read(f"golden/{name}.exr") for name in names}
    assert ours == sr.sha256(stored_pictures)
    if os.environ.get("SPLATREF_GOLDEN_HASH") != "skip":
        said = subprocess.run([program, "golden"], capture_output=True, text=True, check=True).stdout
        assert said.splitlines()[-1] == f"sha256 {ours}"
