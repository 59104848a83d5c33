"""Pictures, cameras and files."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

import splatref as sr
from conftest import ROOT, sphere


def test_a_picture_has_named_planes(picture: sr.Picture) -> None:
    assert picture["Z"].shape == (48, 64) and picture["Z"].dtype == np.float32
    assert picture["RGB"].shape == picture["normal"].shape == (48, 64, 3)
    assert picture["visibility.id"].dtype == np.uint32 and picture["attributes.count"].dtype == np.uint8
    assert picture["attributes"] is picture["attributes.RGB"] and picture["rgb"] is picture["RGB"]
    assert picture["id"][0, 0] == sr.NO_ID and np.isinf(picture["Z"][0, 0])
    assert picture["Z"][10, 32] < np.inf and picture.size == (64, 48) and "Z" in picture and "z" not in picture
    with pytest.raises(KeyError, match="no plane is called 'depth'; there are visibility.Z"):
        picture["depth"]
    assert picture.tally["drawn"] > 0 and sum(picture.times.values()) > 0
    assert picture.settings["cutoff"] == "2" and picture.method == "ewa"


def test_a_picture_shows_itself(picture: sr.Picture, tmp_path: Path) -> None:
    png = picture._repr_png_()
    assert png is not None and png.startswith(b"\x89PNG")
    picture.to_png(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes() == png


def test_a_file_holds_what_the_program_writes(
    scene: sr.Scene, camera: sr.Camera, picture: sr.Picture, program: Path, tmp_path: Path
) -> None:
    picture.save(tmp_path / "a.exr")
    subprocess.run(
        [program, "render", "sphere", "--count", "2000", "--size", "64x48", "--stages", "-o", tmp_path / "b.exr"],
        check=True,
        capture_output=True,
    )
    assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()
    assert (tmp_path / "b.png").read_bytes() == picture._repr_png_()
    again = sr.read(tmp_path / "a.exr")
    assert sr.compare(again, picture).equal and sorted(again) == sorted(picture)
    assert 'name = "ewa"' in picture.text


def test_settings_are_those_of_the_command_line(scene: sr.Scene, camera: sr.Camera) -> None:
    narrow = sr.render(scene, camera, epsilon="0.5r", cull=False, cutoff=np.float32(2))
    assert narrow.settings["epsilon"] == "0.5r" and narrow.settings["cull"] == "off"
    assert narrow.settings["cutoff"] == "2"
    groups = sr.render(scene, camera, method="single-pass", groups=3, overlap=1)
    assert groups.method == "single-pass"
    glass = sr.Scene(**sphere(), environment="sky")
    refracted = sr.render(glass, camera, method="transparent-hq", refraction=[0.5, 0.5, 0.25])
    assert refracted.settings["refraction"] == "0.5,0.5,0.25"
    for wrong, says in [
        ({"epsilon": "near"}, "epsilon `near`; give world units such as 0.25"),
        ({"cutoff": 99}, "cut-off"),
        ({"number": "f16"}, "number `f16`; give one of f32, f64"),
        ({"number": "f64", "storage": "f16"}, "storage"),
        ({"cull": 3}, "cull `3`; give true or false"),
        ({"method": "ewe"}, "ewe"),
        ({"groups": 3}, "has no groups, so overlap, groups and their like"),
        ({"levels": "radius"}, "`levels` does not apply to the method ewa"),
        ({"frame": 1}, "frame 1 of sphere"),
        ({"epsilon": object()}, "epsilon="),
    ]:
        with pytest.raises(ValueError) as error:
            sr.render(scene, camera, **wrong)
        assert says in str(error.value) and "--" not in str(error.value), error.value
    with pytest.raises(TypeError, match="has no setting 'epsilom'"):
        sr.render(scene, camera, epsilom=1)
    with pytest.raises(TypeError, match="camera: dict"):
        sr.render(scene, {})  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="scene: str"):
        sr.render("sphere")  # type: ignore[arg-type]


def test_f64_is_float64_and_rounds_to_the_file(scene: sr.Scene, camera: sr.Camera, tmp_path: Path) -> None:
    exact = sr.render(scene, camera, number="f64", stages=True)
    assert exact["Z"].dtype == np.float64 and exact["id"].dtype == np.uint32
    exact.save(tmp_path / "a.exr")
    again = sr.read(tmp_path / "a.exr")
    assert np.array_equal(again["Z"], exact["Z"].astype(np.float32)) and sr.compare(again, exact).equal


def test_matrices_are_the_camera_of_eye_and_target() -> None:
    scene = sr.Scene(**sphere())
    plain = sr.Camera(eye=(1, 2, 4), target=(0, 0.5, 0), fov=40, size=(64, 48))
    first = sr.render(scene, plain)
    resolved = first.camera
    assert resolved.size == (64, 48) and np.allclose(resolved.eye, [1, 2, 4], atol=1e-6)
    seen = resolved.world_to_camera @ [0, 0.5, 0, 1]
    assert np.allclose(seen[:2], 0, atol=1e-6) and seen[2] > 4, "the target is before the camera"
    assert np.array_equal(scene.camera(plain).K, resolved.K)
    assert sr.compare(first, sr.render(scene, resolved)).equal, "bit for bit"
    cv, k = resolved.world_to_camera, resolved.K
    gl = np.diag([1.0, -1, -1, 1]) @ cv
    for camera in [
        sr.Camera(K=k, world_to_camera=cv, size=(64, 48), convention="opencv", near=resolved.near),
        sr.Camera(K=k, world_to_camera=cv[:3], size=(64, 48), convention="opencv", near=resolved.near),
        sr.Camera(K=k, camera_to_world=np.linalg.inv(gl), size=(64, 48), convention="opengl", near=resolved.near),
        sr.Camera(K=k.tolist(), world_to_camera=gl, size=(64, 48), convention="blender", near=resolved.near),
    ]:
        assert np.allclose(sr.render(scene, camera)["RGB"], first["RGB"], atol=1e-4)


@pytest.mark.parametrize(
    "given, says",
    [
        ({"K": np.eye(3)}, "K is in pixels of a picture; give its size too"),
        ({"K": [[9, 1, 0], [0, 9, 0], [0, 0, 1]], "size": (8, 8)}, "skew"),
        ({"K": np.eye(4), "size": (8, 8)}, "K: an array of float64 with the shape (4, 4)"),
        ({"K": [[9, 0, 0], [0, 9, 0], [1, 0, 1]], "size": (8, 8)}, "no matrix"),
        ({"world_to_camera": np.eye(4)}, "the matrices need a convention"),
        ({"world_to_camera": 2 * np.eye(4), "convention": "opencv"}, "last row"),
        ({"world_to_camera": np.diag([1, 1, -1, 1]), "convention": "opencv"}, "mirror"),
        ({"convention": "opencv"}, "belong to a pose"),
        ({"world_to_camera": np.eye(4), "convention": "maya"}, "maya"),
        ({"eye": (0, 0)}, "eye: invalid length 2"),
        ({"eye": (0, 0, 1), "world_to_camera": np.eye(4), "convention": "opengl"}, "a matrix replaces eye"),
        ({"fov": 40, "focal": 3}, "fov"),
        ({"size": (0, 4)}, "a picture of 0 x 4 pixels"),
        ({"eye": "here"}, "eye"),
        ({"file": "none.json"}, "none.json"),
        ({"stereo": 0.1}, "choose an eye"),
        ({"stereo": 0, "stereo_eye": "left"}, "give a distance above 0"),
        ({"stereo_eye": "left"}, "add stereo"),
    ],
)
def test_wrong_cameras_are_one_line(given: dict, says: str) -> None:
    with pytest.raises((ValueError, OSError)) as error:
        sr.render(sr.Scene.open("sphere", count=100), sr.Camera(**given))
    assert says in str(error.value) and "line " not in str(error.value), error.value


def test_the_eyes_of_a_stereo_pair_stand_beside_the_camera() -> None:
    scene = sr.Scene(**sphere())
    eyes = [sr.Camera(eye=(0, 0, 4), target=(0, 0, 0), stereo=0.5, stereo_eye=eye) for eye in ("left", "right")]
    left, right = sr.render(scene, eyes)
    assert left.camera.eye[0] == -0.25 and right.camera.eye[0] == 0.25
    assert sr.compare(left, sr.render(scene, left.camera)).equal


def test_cameras_of_a_file(tmp_path: Path) -> None:
    pose = np.eye(4)
    frames = []
    for i in range(3):
        pose[2, 3] = 4 + i
        frames.append({"file_path": f"r_{i}", "transform_matrix": pose.tolist()})
    text = json.dumps({"camera_angle_x": 0.7, "w": 32, "h": 24, "frames": frames})
    (tmp_path / "transforms.json").write_text(text)
    cameras = sr.Camera.all(tmp_path / "transforms.json")
    pictures = sr.render(sr.Scene(**sphere()), cameras)
    assert [p.camera.eye[2] for p in pictures] == [4, 5, 6]
    named = sr.Camera(file=tmp_path / "transforms.json", view="r_2")
    assert sr.compare(sr.render(sr.Scene(**sphere()), named), pictures[2]).equal
    assert sr.render(sr.Scene(**sphere()), [named])[0].size == (32, 24)


def test_scenes_of_files_and_texts(tmp_path: Path) -> None:
    scene = sr.Scene.open(ROOT / "golden" / "ball.ply")
    assert scene.name == "ball" and scene.count > 0
    text = 'light = []\n[[model]]\nshape = "torus"\ncount = 900\n[method]\nname = "pyramid"\n'
    torus = sr.Scene.parse(text, name="mine")
    assert torus.name == "mine" and torus.frames == 1
    assert sr.render(torus, sr.Camera(size=(32, 24))).method == "pyramid"
    assert sr.render(torus, sr.Camera(size=(32, 24)), method="ewa").method == "ewa"
    (tmp_path / "a.toml").write_text(text)
    assert sr.Scene.open(tmp_path / "a.toml").count == torus.count
    for name, kind in [("none.ply", OSError), ("a.xyz", ValueError), ("", ValueError)]:
        with pytest.raises(kind):
            sr.Scene.open(name)
    with pytest.raises(FileNotFoundError) as error:
        sr.Scene.open("none.ply")
    assert error.value.filename == "none.ply" and error.value.errno == 2
    with pytest.raises(ValueError, match="line 2"):
        sr.Scene.parse("[[model]]\nshop = 3")
    with pytest.raises(ValueError, match="count and seed apply"):
        sr.Scene.open(ROOT / "golden" / "ball.ply", count=3)


def test_the_truth_and_an_explanation(scene: sr.Scene, camera: sr.Camera, picture: sr.Picture) -> None:
    true = sr.truth(scene, camera)
    found = sr.metrics.errors(picture, true)
    assert found["rmse"] is not None and 0 < found["rmse"] < 0.1 and found["flip"] is not None
    assert "surfel" in sr.explain(scene, camera, (32, 24))
    with pytest.raises(ValueError, match="outside the picture"):
        sr.explain(scene, camera, (64, 0))
    for pixel in [(-1, 0), (1,), "ab", (2**40, 0)]:
        with pytest.raises(ValueError, match="pixel"):
            sr.explain(scene, camera, pixel)  # type: ignore[arg-type]
    assert sr.truth(sr.Scene(**sphere()), camera)["RGB"].shape == (48, 64, 3)


def test_files_that_cannot_be_written(picture: sr.Picture, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="ends in .exr"):
        picture.save(tmp_path / "a.png")
    with pytest.raises(OSError):
        picture.save(tmp_path / "none" / "a.exr")
    with pytest.raises(OSError):
        picture.to_png(tmp_path / "none" / "a.png")
    with pytest.raises(ValueError, match="compression"):
        picture.save(tmp_path / "a.exr", compression="rar")
    assert list(tmp_path.iterdir()) == []


def test_arrays_of_a_picture_are_taken_back(scene: sr.Scene, camera: sr.Camera, picture: sr.Picture) -> None:
    surfels = scene.surfels
    again = sr.Scene(**surfels)
    ours = sr.render(again, picture.camera, stages=True)
    assert sr.compare(picture, ours).equal, "the same surfels, camera and lights"
