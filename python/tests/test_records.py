"""Projected splats, out and in."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

import splatref as sr

ROOT = Path(__file__).resolve().parents[2]
SPLATS = ROOT / "golden" / "splats.glb"


@pytest.mark.parametrize(
    ("name", "options"),
    [(str(SPLATS), {"method": "gaussians", "preset": "khr"}), ("sphere", {"method": "ewa"})],
)
def test_records_are_those_of_the_program(
    program: Path, tmp_path: Path, name: str, options: dict[str, str]
) -> None:
    scene, camera = sr.Scene.open(name), sr.Camera(size=(96, 72))
    command = [program, "project", name, "--size", "96x72", "-o", tmp_path / "records.bin"]
    for key, word in options.items():
        command += [f"--{key}", word]
    subprocess.run(command, check=True, capture_output=True)
    records = sr.project(scene, camera, **options)
    assert len(records) > 50 and records.tobytes() == (tmp_path / "records.bin").read_bytes()


def test_a_verdict_names_the_wrong_field() -> None:
    scene, camera = sr.Scene.open(str(SPLATS)), sr.Camera(size=(96, 72))
    options = {"method": "gaussians", "preset": "khr"}
    planes = {"RGB": sr.render(scene, camera, **options)["RGB"]}
    right = sr.project(scene, camera, **options)
    # In any order, and of any type without loss.
    columns = {name: right[name][::-1].astype(np.float64) for name in right.dtype.names if right[name].dtype == "f4"}
    columns |= {name: right[name][::-1].astype(np.int64) for name in right.dtype.names if right[name].dtype == "u4"}
    for records in (right, right[::-1].copy(), columns):
        verdict = sr.verify(scene, camera, planes, records=records, **options)
        assert verdict.right and verdict.stage("projection").planes, str(verdict)
    wrong = right.copy()
    wrong["covariance"][:, 1] *= -1
    verdict = sr.verify(scene, camera, planes, records=wrong, **options)
    assert verdict.stage("projection").wrong and "covariance" in str(verdict), str(verdict)


def test_bad_records_are_one_clear_error() -> None:
    scene, camera = sr.Scene.open("sphere", count=500), sr.Camera(size=(32, 24))
    planes = {"RGB": sr.render(scene, camera)["RGB"]}
    right = sr.project(scene, camera)
    columns = {name: right[name] for name in right.dtype.names}
    third = np.full(right["amplitude"].shape, 1 / 3)
    for records, text in [
        (np.concatenate([right, right[:1]]), "has two records; remove one"),
        (right["center"], "give a structured array as `project` returns it"),
        (right.tobytes(), "give a structured array"),
        ({name: columns[name] for name in columns if name != "range"}, "without range; give the fields center"),
        (columns | {"depth": third}, "with 'depth'; give the fields"),
        (columns | {"amplitude": third}, "is no float32"),
        (columns | {"amplitude": third[:-1].astype(np.float32)}, r"the shape \(\d+,\); give \(\d+,\)"),
        (columns | {"bounds": right["bounds"][:, 0]}, r"records\['bounds'\]: an array with the shape"),
        (columns | {"surfel": right["surfel"].astype(np.int64) - 1000}, "indices from -"),
        (columns | {"surfel": right["center"]}, r"records\['surfel'\]: an array with the shape"),
        (columns | {"center": 3.0}, r"records\['center'\]: an array with the shape \(\)"),
        (columns | {"center": "many"}, r"records\['center'\]"),
    ]:
        with pytest.raises(ValueError, match=text):
            sr.verify(scene, camera, planes, records=records)
    with pytest.raises(ValueError, match='records are f32; give number="f32"'):
        sr.project(scene, camera, number="f64")
    with pytest.raises(ValueError, match="blue draws no splats; give another method"):
        sr.project(scene, camera, method="blue")
    with pytest.raises(ValueError, match="this method draws no splats"):
        sr.verify(scene, camera, planes, records=right, method="blue")
    nan = right.copy()
    nan["conic"] = np.nan
    assert not sr.verify(scene, camera, planes, records=nan).right
    assert sr.verify(scene, camera, planes, records=right[:0]).outcome != "right"
