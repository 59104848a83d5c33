"""Samplers and laws."""

from __future__ import annotations

import numpy as np
import pytest

import splatref as sr
from conftest import sphere

POINTS = sphere(3000)["positions"]


def farthest(points: np.ndarray, count: int, start: int) -> list[int]:
    """The definition of the greedy order, in float32."""
    least, picks = np.full(len(points), np.inf, np.float32), [start]
    while len(picks) < count:
        d = points - points[picks[-1]]
        least = np.minimum(least, (d[:, 0] * d[:, 0] + d[:, 1] * d[:, 1]) + d[:, 2] * d[:, 2])
        picks.append(int(np.argmax(least)))
    return picks


def test_greedy_is_its_definition() -> None:
    order = sr.surfels.greedy(POINTS, count=50, start=3)
    assert order.dtype == np.uint32 and order.tolist() == farthest(POINTS, 50, 3)
    assert len(sr.surfels.greedy(POINTS)) == 3000
    assert np.array_equal(sr.surfels.greedy(POINTS, count=20, seed=1), sr.surfels.greedy(POINTS, seed=1)[:20])


def test_spreads_rank_the_samplers() -> None:
    spread = {
        "greedy": sr.surfels.quality(POINTS, sr.surfels.greedy(POINTS, count=100)),
        "progressive": sr.surfels.quality(POINTS, sr.surfels.progressive(POINTS, count=100)),
        "shipped": sr.surfels.quality(POINTS, sr.surfels.progressive(POINTS, count=100, as_shipped=True)),
        "random": sr.surfels.quality(POINTS, sr.surfels.random(POINTS, count=100)),
    }
    assert spread["greedy"].packing > spread["progressive"].packing > spread["random"].packing
    assert spread["greedy"].covering < spread["random"].covering and len(spread["shipped"].nearest) == 100
    power = sr.surfels.spectrum(POINTS[sr.surfels.greedy(POINTS, count=500)])
    assert power.power.shape == power.frequency.shape and power.unit > 0


def test_orders_along_a_surface_and_mean_colours() -> None:
    order = sr.surfels.greedy(POINTS, normals=POINTS, reach=0.2, count=30, start=0)
    assert len(set(order.tolist())) == 30
    means = sr.surfels.average_colors(POINTS, np.abs(POINTS), order, count=8)
    assert means.shape == (8, 3) and 0.3 < means.mean() < 0.7


@pytest.mark.parametrize(
    "call, says",
    [
        (lambda: sr.surfels.greedy(POINTS[:, :2]), "points: an array with the shape (3000, 2)"),
        (lambda: sr.surfels.greedy(np.full((3, 3), np.nan, "f4")), "point 0 is not finite"),
        (lambda: sr.surfels.greedy(POINTS, start=3000), "start=3000"),
        (lambda: sr.surfels.greedy(POINTS, start=-1), "start=-1"),
        (lambda: sr.surfels.greedy(POINTS, count=0), "count=0 leaves no point"),
        (lambda: sr.surfels.greedy(POINTS, seed=1.5), "seed=1.5"),  # type: ignore[arg-type]
        (lambda: sr.surfels.greedy(POINTS, reach=1), "belong together"),
        (lambda: sr.surfels.greedy(POINTS, normals=POINTS[1:], reach=1), "normals: the shape (2999, 3)"),
        (lambda: sr.surfels.greedy(POINTS, normals=POINTS, reach=np.nan), "reach=nan"),
        (lambda: sr.surfels.greedy(np.zeros((0, 3), "f4")), "give 1 to 2^32 - 1 points"),
        (lambda: sr.surfels.quality(POINTS, [3000]), "indices from 3000 to 3000, but there are 3000"),
        (lambda: sr.surfels.quality(POINTS, [0.5]), "prefix: an array of float64"),
        (lambda: sr.surfels.quality(POINTS, []), "prefix"),
        (lambda: sr.surfels.spectrum(POINTS[:9]), "a spectrum of 9 points"),
        (lambda: sr.surfels.average_colors(POINTS, POINTS[1:], [0]), "colors: the shape"),
    ],
)
def test_what_cannot_be_ordered(call: object, says: str) -> None:
    with pytest.raises(ValueError) as error:
        call()  # type: ignore[operator]
    assert says in str(error.value), error.value


def over(below: np.ndarray, below_alpha: np.float32, alpha: np.float32, color: np.ndarray) -> tuple:
    keep = np.float32(1) - alpha
    return alpha * color + keep * below, alpha + keep * below_alpha


def test_laws_hold_for_right_functions_and_find_what_breaks_them() -> None:
    assert sr.laws.over(over) is None and sr.laws.over(over, number="f64") is None
    found = sr.laws.over(lambda below, below_alpha, alpha, color: over(below, below_alpha, alpha, color / 2))
    assert found is not None and found.law == "blending is its closed form, up to rounding"
    assert found.kind == "algebraic" and "expected" in str(found)
    lerp = lambda below, ba, a, c: (below + a * (c - below), ba + a * (np.float32(1) - ba))  # noqa: E731
    assert sr.laws.over(lerp, kinds=["algebraic", "odd inputs"]) is None
    broken = sr.laws.over(lerp)
    assert broken is not None and broken.kind == "exact"
    assert sr.laws.epsilon(lambda t, nearest, band: t <= nearest + band) is None
    assert sr.laws.epsilon(lambda t, nearest, band: t - nearest <= band) is not None


def test_every_operator_has_laws() -> None:
    def under(color, alpha, through, layer, layer_color):  # type: ignore[no-untyped-def]
        part = through * layer
        if part > 0:
            color, alpha = color + part * layer_color, alpha + part
        return color, alpha, through * (np.float32(1) - layer)

    assert sr.laws.under(under) is None

    def mean(takes, weights, values):  # type: ignore[no-untyped-def]
        total, weight = np.float32(0), np.float32(0)
        for take, w, v in zip(takes, weights, values):
            if take:
                total, weight = total + w * v, weight + w
        return total / weight

    assert sr.laws.means(mean, kinds=["algebraic"]) is None
    assert sr.laws.means(lambda takes, weights, values: values[0]) is not None
    add = lambda total, weight, color: total + weight * color  # noqa: E731
    with np.errstate(all="ignore"):
        broken = sr.laws.sums(add, lambda total, weight: total)
    assert broken is not None
    divide = lambda total, weight: total / weight if weight > 0 else np.zeros(3)  # noqa: E731
    assert sr.laws.sums(add, divide, kinds=["algebraic"]) is None
    assert sr.laws.bins(lambda of, t: 0.0, lambda of, t, ratio: ratio) is not None
    assert sr.laws.groups(lambda samples, band: (np.zeros(9), 0)) is not None


def test_an_exception_of_a_function_is_raised() -> None:
    class Mine(Exception):
        pass

    def fails(*_: object) -> None:
        raise Mine("here")

    with pytest.raises(Mine, match="here"):
        sr.laws.over(fails)
    for function in (lambda *_: None, lambda *_: ("a", 1), lambda *_: ([1, 2], 1), lambda *_: 3):
        with pytest.raises(ValueError, match="the function must return"):
            sr.laws.over(function)
    with pytest.raises(ValueError, match="kind exakt"):
        sr.laws.over(over, kinds=["exakt"])
    with pytest.raises(ValueError, match="number f16"):
        sr.laws.over(over, number="f16")
    with pytest.raises(TypeError, match="is no function"):
        sr.laws.over(3)  # type: ignore[arg-type]
