"""Arrays of every kind: an exception, or the right answer."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import splatref as sr
from conftest import sphere

CAMERA = sr.Camera(eye=(0, 0, 4), target=(0, 0, 0), fov=40, size=(48, 32))


def drawn(**arrays: Any) -> np.ndarray:
    return sr.render(sr.Scene(**arrays), CAMERA)["RGB"]


@pytest.fixture(scope="module")
def expected() -> np.ndarray:
    return drawn(**sphere())


def test_layouts_and_types_that_lose_nothing_give_the_same_bits(expected: np.ndarray) -> None:
    a = sphere()
    p = a["positions"]
    unaligned = np.frombuffer(b"x" + p.tobytes(), np.uint8)[1:].view(np.dtype("<f4").newbyteorder("<")).reshape(p.shape)
    read_only = p.copy()
    read_only.flags.writeable = False
    rec = np.zeros(len(p), [("a", "i1"), ("p", "f4", 3)])
    rec["p"] = p
    for other in [
        np.asfortranarray(p),
        p[::-1].copy()[::-1],
        np.repeat(p, 2, axis=0)[::2],
        np.ascontiguousarray(p[:, ::-1])[:, ::-1],
        p.astype(np.float64),
        p.astype(np.longdouble),
        p.astype(">f4"),
        p.astype(">f8"),
        read_only,
        unaligned,
        rec["p"],
        p.tolist(),
        p.view(np.matrix),
    ]:
        assert np.array_equal(drawn(**{**a, "positions": other}), expected)
    assert np.array_equal(drawn(**{**a, "radii": float(a["radii"][0])}), expected), "one radius for all"
    assert sr.Scene([[0.1, 0, 0]], normals=[[0, 0, 1]], radii=0.1).median_radius == np.float32(0.1), "lists round"
    assert np.array_equal(drawn(**{**a, "radii": np.broadcast_to(a["radii"][0], 500)}), expected), "stride 0"


def test_whole_numbers_and_objects_with_an_array_are_taken() -> None:
    p = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    n = np.array([[0, 0, 1]] * 3)
    pictures = [drawn(positions=p.astype(t), normals=n.astype("i1"), radii=1) for t in ("i1", "u2", "i8", "f2", "f8")]
    assert all(np.array_equal(one, pictures[0]) for one in pictures)

    class Tensor:
        def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
            return p.astype(np.float32)

    class OnlyDlpack:
        def __dlpack__(self, **more: Any) -> Any:
            return p.astype(np.float32).__dlpack__(**more)

        def __dlpack_device__(self) -> Any:
            return p.__dlpack_device__()

    for tensor in (Tensor(), OnlyDlpack()):
        assert np.array_equal(drawn(positions=tensor, normals=n, radii=1), pictures[0])


class Raises:
    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
        raise RuntimeError("on a GPU")


@pytest.mark.parametrize(
    "name, value, says",
    [
        ("positions", np.zeros((5, 2), "f4"), "positions: an array with the shape (5, 2); give (n, 3)"),
        ("positions", np.zeros(3, "f4"), "positions: an array with the shape (3,); give (n, 3)"),
        ("positions", np.zeros((0, 3), "f4"), "give 1 to 2^32 - 2 points"),
        ("positions", np.zeros((1, 5, 3), "f4"), "(1, 5, 3); give (n, 3)"),
        ("positions", np.array([[0.1, 0, 0]]), "0.1"),
        ("positions", np.array([[2**53 + 1, 0, 0]]), "is no float32"),
        ("positions", np.array([[2**24 + 1, 0, 0]], "i4"), "at [0, 0] is no float32"),
        ("positions", np.array([[2**64 - 1, 0, 0]], "u8"), "is no float32"),
        ("positions", np.array([[1e300, 0, 0]]), "is no float32"),
        ("positions", np.full((2, 3), object()), "positions: an array of object"),
        ("positions", np.zeros((2, 3), complex), "complex128"),
        ("positions", np.zeros((2, 3), "M8[s]"), "datetime64"),
        ("positions", np.zeros((2, 3), "S1"), "positions: an array of |S1"),
        ("positions", np.zeros((2, 3), bool), "bool"),
        ("positions", np.zeros((2, 3), [("x", "f4")]), "positions: an array of"),
        ("positions", np.ma.masked_equal(np.zeros((2, 3), "f4"), 0), "a masked array"),
        ("positions", Raises(), "positions: Raises is no array of the CPU: on a GPU"),
        ("positions", [[1, 2, 3], [1]], "positions: list is no array"),
        ("positions", None, "positions: an array of object"),
        ("positions", "bunny.ply", "give it to Scene.open"),
        ("positions", np.full((2, 3), np.nan, "f4"), "none of its 2 points has a finite position"),
        ("normals", np.zeros((499, 3), "f4"), "normals: an array with the shape (499, 3), but there are 500 positions"),
        ("normals", np.zeros(3, "f4"), "normals: an array with the shape (3,); give (500, 3)"),
        ("radii", np.zeros((500, 1), "f4"), "radii: an array with the shape (500, 1); give (500,)"),
        ("radii", -1.0, "without radius"),
        ("radii", np.full(500, np.nan, "f4"), "without radius"),
        ("colors", np.zeros((500, 4), "f4"), "colors: an array with the shape (500, 4); give (500, 3)"),
        ("colors", np.full((500, 3), -1, "f4"), "bad colour"),
        ("opacities", 2, "bad colour, opacity"),
        ("tangents", np.zeros((500, 3), "f4"), "give (500, 2, 3)"),
        ("lights", [{"kind": "lamp"}], "lamp"),
        ("lights", [3], "lights: 3"),
        ("material", {"shine": 2}, "shine"),
    ],
)
def test_what_cannot_be_is_one_clear_value_error(name: str, value: Any, says: str) -> None:
    with pytest.raises(ValueError) as error:
        sr.Scene(**({} if name == "positions" else sphere()) | {name: value})
    assert says in str(error.value) and "\n" not in str(error.value).strip(), error.value


@pytest.mark.parametrize("dtype", ["f4", "f8"])
def test_claims_of_billions_of_points_are_refused_before_they_are_copied(dtype: str) -> None:
    for count in (2**32, 2**40):
        claimed = np.broadcast_to(np.zeros(3, dtype), (count, 3))
        with pytest.raises((ValueError, MemoryError)):
            sr.Scene(claimed, normals=claimed, radii=1)
    claimed = np.broadcast_to(np.zeros(3, dtype), (2**32 - 2, 3))
    with pytest.raises((ValueError, MemoryError), match="memory"):
        sr.Scene(claimed, normals=claimed, radii=1)


def test_inputs_are_never_changed_and_later_changes_do_not_count(expected: np.ndarray) -> None:
    a = sphere()
    before = {name: one.copy() for name, one in a.items()}
    scene = sr.Scene(**a)
    assert all(np.array_equal(a[name], before[name]) for name in a)
    for one in a.values():
        one[...] = np.nan
    assert np.array_equal(sr.render(scene, CAMERA)["RGB"], expected)


def test_points_that_cannot_be_surfels_are_dropped_and_counted() -> None:
    a = sphere()
    a["positions"][7] = np.inf
    a["normals"][8] = 0
    scene = sr.Scene(**a)
    assert scene.count == 498 and scene.dropped == "1 not finite, 1 without normal"


def test_arrays_that_another_thread_changes_are_an_exception_or_a_picture() -> None:
    a = sphere(20_000)
    stop = threading.Event()

    def change() -> None:
        values = np.array([1.0, np.nan, -1.0, np.inf], np.float32)
        while not stop.is_set():
            for one in a.values():
                one.reshape(-1)[:] = np.random.choice(values, one.size)

    thread = threading.Thread(target=change)
    thread.start()
    try:
        for _ in range(10):
            try:
                found = sr.render(sr.Scene(**a), CAMERA)
            except ValueError:
                continue
            assert not np.isnan(found["Z"]).any()
    finally:
        stop.set()
        thread.join()


def test_missing_normals_and_radii_are_derived() -> None:
    p = sphere(2000)["positions"]
    scene = sr.Scene(p)
    made = scene.surfels
    assert np.mean(np.sum(made["normals"] * p, axis=1)) > 0.99 and (made["radii"] > 0).all()
    assert np.array_equal(made["positions"], p)


def test_a_scene_without_lights_shows_its_colours() -> None:
    a = sphere()
    found = sr.render(sr.Scene(**a, colors=np.full((500, 3), 0.25, "f4"), lights=[]), CAMERA)
    assert np.allclose(found["RGB"][16, 24], 0.25)
    sky = sr.render(sr.Scene(**a, environment="sky", material={"specular": 0}), CAMERA)
    assert (sky["A"] == 1).all()


def gaussians(**other: object) -> sr.Scene:
    i = np.arange(40, dtype=np.float32)
    arrays: dict[str, object] = {
        "scales": np.full((40, 3), 0.125, np.float32),
        "rotations": np.tile(np.array([0, 0, 0.5, 1], np.float32), (40, 1)),
        "opacities": np.full(40, 0.5, np.float32),
        "harmonics": np.full((40, 4, 3), 0.25, np.float32),
        **other,
    }
    positions = np.stack([i % 8 - 3.5, i // 8 - 2, -i / 64], axis=1)
    return sr.Scene.gaussians(positions, **arrays)


def test_gaussians_are_drawn_and_judged() -> None:
    camera = sr.Camera(eye=(0, 0, 9), target=(0, 0, 0), size=(48, 32))
    scene = gaussians()
    assert scene.count == 40
    picture = sr.render(scene, camera, method="gaussians", preset="khr")
    assert set(np.unique(picture["id"])) >= {0, 39}
    assert sr.verify(scene, camera, dict(picture), method="gaussians", preset="khr").outcome == "right"
    wrong = sr.verify(scene, camera, dict(picture), method="gaussians", preset="khr", low_pass=0.1)
    assert wrong.outcome == "wrong"
    with pytest.raises(ValueError, match="use method gaussians"):
        sr.render(scene, camera, method="ewa")


def test_gaussians_are_mixed_with_a_surface(tmp_path: Path) -> None:
    camera = sr.Camera(eye=(0, 0, 9), target=(0, 0, 0), size=(48, 32))
    opaque = sr.render(sr.Scene(**sphere()), camera)
    opaque.save(tmp_path / "opaque.exr")
    bare, mixed = gaussians(), gaussians(surface=tmp_path / "opaque.exr", environment="sky")
    picture = sr.render(mixed, camera, method="gaussians")
    assert (picture["A"] == 1).all() and np.isfinite(opaque["Z"]).any()
    assert (picture["count"] <= sr.render(bare, camera, method="gaussians")["count"]).all()
    untouched = np.isfinite(opaque["Z"]) & (picture["count"] == 0)
    assert (picture["RGB"][untouched] == opaque["RGB"][untouched]).all()
    assert sr.verify(mixed, camera, dict(picture), method="gaussians").outcome == "right"
    assert sr.verify(bare, camera, dict(picture), method="gaussians").outcome == "wrong"


def test_arrays_of_gaussians_that_do_not_fit_are_named() -> None:
    with pytest.raises(ValueError, match="scales: .*give"):
        gaussians(scales=np.ones((39, 3), np.float32))
    with pytest.raises(ValueError, match="harmonics: .*1, 4, 9 or 16"):
        gaussians(harmonics=np.ones((40, 5, 3), np.float32))
    with pytest.raises(ValueError, match="none of its 40 Gaussians"):
        gaussians(opacities=np.full(40, 2, np.float32))
    some = np.full(40, 0.5, np.float32)
    some[3] = np.nan
    assert "1 Gaussians" in gaussians(opacities=some).dropped
