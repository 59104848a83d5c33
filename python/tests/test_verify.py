"""Verdicts, comparisons and metrics."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

import splatref as sr


@pytest.fixture(scope="module")
def right(picture: sr.Picture) -> dict[str, np.ndarray]:
    return {name: picture[name] for name in ("visibility.Z", "visibility.id", "RGB")}


def test_right_planes_are_right(scene: sr.Scene, camera: sr.Camera, right: dict) -> None:
    verdict = sr.verify(scene, camera, right)
    assert verdict.right and verdict.outcome == "right" and verdict.worst is None and verdict.causes == []
    assert verdict.stage("visibility").planes == ("visibility.Z", "visibility.id")
    error = verdict.error["visibility.Z"]
    assert error.shape == (48, 64) and 0 < error.max() <= 1 and error is verdict.error["visibility"]
    assert verdict.undecided.dtype == bool and 0 < verdict.undecided.sum() < 20
    assert "rgb" in verdict.error and verdict.error["rgb"] is verdict.error["RGB"]
    with pytest.raises(KeyError, match="no stage and no judged plane is called 'x'"):
        verdict.error["x"]
    html = verdict._repr_html_()
    assert "visibility" in html and "right" in html
    assert str(verdict).splitlines()[-1] == repr(verdict)[len("<Verdict: ") : -1]


def test_types_layouts_and_origins_of_planes(scene: sr.Scene, camera: sr.Camera, right: dict) -> None:
    z, ids, rgb = right["visibility.Z"], right["visibility.id"], right["RGB"]
    with np.errstate(divide="ignore"):
        inverse = (1 / z).astype(np.float32)
    for planes, more in [
        ({"visibility.Z": z.astype(np.float64), "visibility.id": ids.astype(np.int64)}, {}),
        ({"visibility.Z": z[..., None], "visibility.id": ids.view(np.int32)}, {}),
        ({"visibility.Z": z[None], "visibility.id": np.where(ids == sr.NO_ID, -1, ids.astype(np.int64))}, {}),
        ({"rgb": np.moveaxis(rgb, -1, 0)[None]}, {}),
        ({"RGB": rgb.astype(np.float16)}, {}),
        ({"visibility.Z": z[::-1], "visibility.id": ids[::-1]}, {"origin": "bottom-left"}),
        ({"visibility.Z": np.asfortranarray(z).astype(">f4"), "visibility.id": ids.astype(">u4")}, {}),
        ({"visibility.Z": {"data": inverse, "meaning": "1/t"}, "visibility.id": ids}, {}),
        ({"visibility.Z": inverse, "visibility.id": ids}, {"depth": {"meaning": "1/t"}}),
        ({"visibility.id": {"data": np.where(ids == sr.NO_ID, 0, ids + 1), "id_base": 1}}, {}),
    ]:
        verdict = sr.verify(scene, camera, planes, **more)
        assert verdict.right, (list(planes), str(verdict))


def test_a_mistake_is_named(scene: sr.Scene, camera: sr.Camera) -> None:
    wrong = sr.render(scene, camera, stages=True, epsilon="1r")
    verdict = sr.verify(scene, camera, wrong)
    assert verdict.outcome == "wrong" and verdict.causes == ["epsilon is half as wide"]
    assert verdict.worst is not None and verdict.worst.stage == "attributes" and verdict.worst.error > 1
    x, y = verdict.worst.pixel
    assert verdict.error["attributes"][y, x] > 1 and "surfel" in verdict.explain(x, y)
    assert verdict.stage("attributes").wrong > 0 and "WRONG in" in str(verdict)
    assert verdict.json["looks_like"] == "epsilon is half as wide" and verdict.json["outcome"] == "wrong"
    assert sr.verify(scene, camera, wrong, cause=False).causes == []
    assert "looks like: epsilon" in verdict._repr_html_()


def test_the_lines_and_the_json_are_those_of_the_program(
    scene: sr.Scene, camera: sr.Camera, program: Path, tmp_path: Path
) -> None:
    wrong = sr.render(scene, camera, stages=True, epsilon="1r")
    wrong.save(tmp_path / "gpu.exr")
    verdict = sr.verify(scene, camera, wrong)
    command = [program, "verify", "sphere", "gpu.exr", "--count", "2000", "--size", "64x48"]
    files = ["--json", "a.json", "--report", "a.html"]
    said = subprocess.run([*command, *files], cwd=tmp_path, capture_output=True, text=True)
    assert said.returncode == 1
    ours, theirs = ([x for x in t.splitlines() if not x.startswith("replay")] for t in (str(verdict), said.stdout))
    assert ours == theirs
    theirs_json = json.loads((tmp_path / "a.json").read_text())
    ours_json = verdict.json
    assert ours_json.pop("replay").startswith("verdict.explain(") and theirs_json.pop("replay")
    assert ours_json == theirs_json
    verdict.report(tmp_path / "b.html")
    page = (tmp_path / "b.html").read_text()
    assert "verdict.explain(" in page and len(page) > 10_000
    with pytest.raises(OSError):
        verdict.report(tmp_path / "none" / "b.html")


@pytest.mark.parametrize(
    "planes, more, says",
    [
        ({}, {}, "no plane"),
        ({"depth": np.zeros((48, 64), "f4")}, {}, "no plane is called `depth`; there are visibility.Z"),
        ({"Z": np.zeros((4, 4), "f4")}, {}, "4 x 4 pixels, but the camera's picture has 64 x 48"),
        ({"Z": np.zeros((48, 64), "f4"), "id": np.zeros((4, 4), "u4")}, {}, "planes.id: 4 x 4 pixels"),
        ({"Z": np.zeros((48, 64, 3), "f4")}, {}, "planes.Z: 3 numbers a pixel"),
        ({"RGB": np.zeros((48, 64), "f4")}, {}, "planes.RGB: 1 numbers a pixel"),
        ({"Z": np.zeros(5, "f4")}, {}, "planes['Z']: an array of float32 with the shape (5,)"),
        ({"Z": np.zeros((0, 64), "f4")}, {}, "give (height, width)"),
        ({"Z": np.zeros((2, 2), object)}, {}, "planes['Z']: an array of object"),
        ({"id": np.full((48, 64), 2**40)}, {}, "planes['id']: whole numbers from"),
        ({"id": np.full((48, 64), -2)}, {}, "planes['id']: whole numbers from -2"),
        ({"id": np.full((48, 64), 0.5, "f4")}, {}, "planes.id:"),
        ({"Z": np.zeros((48, 64), "i4")}, {}, "planes.Z: whole numbers"),
        ({"Z": {"meaning": "1/t"}}, {}, "without \"data\""),
        ({"Z": {"data": np.zeros((48, 64), "f4"), "meaning": "1/z"}}, {}, "give one of \"t\""),
        ({"Z": {"data": np.zeros((48, 64), "f4"), "scale": 2}}, {}, "unknown key `scale`"),
        ({"id": {"data": np.zeros((48, 64), "u4"), "near": 2}}, {}, "`near` does not apply"),
        ({"Z": np.ma.zeros((48, 64))}, {}, "a masked array"),
        ({"Z": np.zeros((48, 64), "f4")}, {"promise": "best"}, "promise best; give gpu, precise or ieee"),
        ({"Z": np.zeros((48, 64), "f4")}, {"budget": 2}, "budget 2; give a fraction"),
        ({"Z": np.zeros((48, 64), "f4")}, {"ties": "none"}, "ties is \"none\""),
        ({"Z": np.zeros((48, 64), "f4")}, {"storage": "f16"}, "storage f32"),
        ({"Z": np.zeros((48, 64), "f4"), "visibility.Z": [[1, 2], [3]]}, {}, "list is no array"),
    ],
)
def test_planes_that_cannot_be_judged(scene: sr.Scene, camera: sr.Camera, planes: dict, more: dict, says: str) -> None:
    with pytest.raises(ValueError) as error:
        sr.verify(scene, camera, planes, **more)
    text = str(error.value)
    assert says in text and "\n" not in text and not text.startswith(": "), text


def test_comparisons_say_where_and_how_much(picture: sr.Picture, tmp_path: Path) -> None:
    same = sr.compare(picture, dict(picture))
    assert same.equal and same.passed and str(same).endswith("bit for bit")
    other = {name: plane.copy() for name, plane in picture.items()}
    other["Z"][10, 32] = np.nextafter(other["Z"][10, 32], np.float32(9))
    found = sr.compare(picture, other)
    assert found.verdict == "different" and not found.passed
    assert found["Z"]["first"][0] == (32, 10) and found["Z"]["max_ulp"] == 1 and found["Z"]["differing"] == 1
    assert sr.compare(picture, other, tolerance={"Z": {"ulp": 4}}).verdict == "within"
    assert sr.compare(picture, other, max_ulp=1).verdict == "within"
    assert sr.compare(picture, other, planes=["id", "normal"]).equal
    picture.save(tmp_path / "a.exr")
    np.save(tmp_path / "Z.npy", picture["Z"])
    assert sr.compare(tmp_path / "a.exr", picture).equal
    assert sr.compare(tmp_path / "Z.npy", {"Z": picture["Z"]}).equal
    for wrong, says in [
        ({"planes": ["depth"]}, "no plane of the reference is called `depth`"),
        ({"tolerance": {"Z": {"ulps": 4}}}, "a tolerance has ulp, abs and pixels"),
        ({"tolerance": {"Z": {"ulp": -1}}}, "ulp=-1"),
        ({"tolerance": {"y": {"ulp": 1}}}, "`y`"),
        ({"max_abs": -1.0}, "abs=-1.0"),
    ]:
        with pytest.raises(ValueError, match=says):
            sr.compare(picture, other, **wrong)
    assert sr.compare({"Z": picture["Z"]}, {"Z": picture["Z"][1:]}).verdict == "different"
    for bad in [tmp_path / "a.png", {}, {"Z": np.zeros(3)}]:
        with pytest.raises((ValueError, OSError)):
            sr.compare(bad, picture)
    with pytest.raises(TypeError):
        sr.compare(3, picture)  # type: ignore[arg-type]


def test_one_hash_for_many_pictures(picture: sr.Picture) -> None:
    assert sr.sha256({}).startswith("e3b0c44298fc1c149afbf4c8996fb924")
    assert sr.sha256({"a": picture}) == sr.sha256({"a": dict(picture)}) != sr.sha256({"b": picture})


def test_metrics_are_those_of_the_program(scene: sr.Scene, camera: sr.Camera, picture: sr.Picture) -> None:
    other = sr.render(scene, camera, method="pyramid")
    table = sr.metrics.errors(other, picture)
    assert sr.metrics.rmse(other, picture) == pytest.approx(table["rmse"], rel=1e-12)
    assert sr.metrics.psnr(other, picture) == pytest.approx(table["psnr"], rel=1e-12)
    assert sr.metrics.ssim(other, picture) == pytest.approx(table["ssim"], rel=1e-12)
    assert sr.metrics.flip(other, picture) == table["flip"]
    assert sr.metrics.flip_map(other["RGB"], picture["RGB"]).shape == (48, 64)
    assert sr.metrics.flip(picture, picture) == 0 and sr.metrics.psnr(picture, picture) == np.inf
    small = np.zeros((4, 4, 3), np.float32)
    for call in [
        lambda: sr.metrics.ssim(small, small),
        lambda: sr.metrics.rmse(small, picture),
        lambda: sr.metrics.rmse(small[..., 0], small[..., 0]),
        lambda: sr.metrics.flip(small, small, pixels_per_degree=0),
        lambda: sr.metrics.errors({"RGB": small}, {"RGB": small}),
        lambda: sr.metrics.rmse({"Z": small[..., 0]}, {"Z": small[..., 0]}),
    ]:
        with pytest.raises(ValueError):
            call()


@pytest.mark.parametrize("method", list(sr.methods.names()))
def test_the_planes_of_every_method_are_right(scene: sr.Scene, method: str) -> None:
    camera = sr.Camera(size=(32, 24))
    own = sr.render(scene, camera, method=method, stages=True)
    verdict = sr.verify(scene, camera, own, method=method, budget=1.0)
    assert verdict.outcome in ("right", "unlike") and verdict.json["method"] == method
    known = {row.name for row in sr.methods.planes(method)}
    assert {"Z", "RGB"} <= known
