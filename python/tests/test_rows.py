"""Settings have one row each: the command line, scene files and Python say the same."""

from __future__ import annotations

import inspect
import re
import subprocess
from pathlib import Path

import pytest

import splatref as sr
from conftest import ROOT
from splatref._text import ROWS


def test_every_row_is_an_option_with_the_same_words(program: Path) -> None:
    said = subprocess.run([program, "render", "--help"], capture_output=True, text=True, check=True).stdout
    blocks = {}
    for block in re.split(r"\n(?= +(?:-\w, )?--)", said):
        name = re.match(r" +(?:-\w, )?--([a-z-]+)", block)
        if name:
            blocks[name[1]] = " ".join(block.split())
    assert len(ROWS) > 30
    for row in ROWS:
        block = blocks[row["option"]]
        description = row["description"]
        assert description[0].upper() + description[1:] in block, row["name"]
        # A switch may stand without a value, and has its form in brackets.
        assert f"{row['form']}>" in block, row["name"]
        for default in row["defaults"].values():
            if default:
                assert "[default: " in block and default in block, row["name"]


def test_every_row_is_a_key_of_the_example_of_scene_files() -> None:
    example = (ROOT / "src/io/scene_file/example.toml").read_text()
    for row in ROWS:
        assert re.search(rf"^(# )?{row['key']} = ", example, re.MULTILINE), row["name"]


def test_every_row_is_a_keyword_and_its_default_is_taken(scene: sr.Scene) -> None:
    camera = sr.Camera(size=(16, 12))
    tried = 0
    for row in ROWS:
        for method, default in row["defaults"].items():
            if default is None:
                continue
            plain = sr.render(scene, camera, method=method or None)
            try:
                given = sr.render(scene, camera, method=method or None, **{row["name"]: default})
            except ValueError as error:
                assert "has no effect" in str(error), error
                continue
            if row["table"] != "groups":
                assert sr.compare(plain, given).equal, (method, row["name"])
            tried += 1
    assert tried > 60


@pytest.mark.parametrize("row", [row for row in ROWS if row["range"] and row["form"] in ("X", "N")], ids=lambda row: row["name"])
def test_what_is_out_of_range_says_the_same_everywhere(row: dict, program: Path, tmp_path: Path) -> None:
    method = next(iter(row["defaults"]))
    value = "-1" if row["form"] == "X" else "4000000000"
    scene = sr.Scene.open("sphere", count=100)
    with pytest.raises(ValueError) as ours:
        sr.render(scene, sr.Camera(size=(8, 8)), method=method, **{row["name"]: value})
    command = [program, "render", "sphere", "--count", "100", "--size", "8x8", "--method", method]
    said = subprocess.run(
        [*command, f"--{row['option']}", value, "-o", tmp_path / "a.exr"], capture_output=True, text=True
    )
    assert said.returncode == 2
    words = said.stderr.strip().removeprefix("splatref: ")
    assert str(ours.value) in words or words.replace("--", "") in str(ours.value), (words, ours.value)


def test_methods_and_planes_are_listed() -> None:
    assert list(sr.methods.names())[0] == "ewa" and len(sr.methods.names()) == 10
    planes = sr.methods.planes("ewa")
    assert ("visibility", "visibility.Z") in [(row.stage, row.name) for row in planes]
    assert "RGB" in [row.name for row in planes]
    names = [row.name for row in sr.methods.settings("pyramid")]
    assert "number" in names and "cutoff" not in names
    with pytest.raises(ValueError, match="no method is called"):
        sr.methods.settings("ewe")
    with pytest.raises(ValueError):
        sr.methods.planes("ewe")


def test_every_public_name_has_a_docstring() -> None:
    modules = [sr, sr.laws, sr.methods, sr.metrics, sr.surfels, sr.testing]
    for module in modules:
        for name in module.__all__:
            one = getattr(module, name)
            if inspect.isfunction(one) or inspect.isclass(one):
                assert inspect.getdoc(one), f"{module.__name__}.{name}"
