"""Orders of points of which every prefix covers the surface, and how evenly a prefix is spread [BJFM19].

Points are arrays (n, 3), as for `splatref.Scene`. An order is an array of indices, uint32.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np

from . import _splatref
from ._arrays import Array, float32, indices
from ._call import calling

__all__ = ["Spread", "Spectrum", "average_colors", "greedy", "progressive", "quality", "random", "spectrum"]


@dataclass
class _Sampler:
    """What the Rust side reads of a sampler."""

    name: str
    count: int
    start: Optional[int]
    seed: int
    along: Optional[tuple[Array, float]] = None


def _points(points: object) -> Array:
    found = float32("points", points, (None, 3))
    if not 0 < len(found) < 1 << 32:
        raise ValueError(f"points: an array with the shape {found.shape}; give 1 to 2^32 - 1 points")
    return found


def _whole(name: str, value: Optional[int], below: int) -> Optional[int]:
    if value is None:
        return None
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)) or not 0 <= value < below:
        raise ValueError(f"{name}={value!r}; give a whole number from 0, below {below}")
    return int(value)


def _ordered(points: Array, sampler: _Sampler, progress: Optional[bool]) -> Array:
    with calling(progress) as how:
        order: Array = _splatref.order(how, points, sampler)[0]
    return order


def _count(points: Array, count: Optional[int]) -> int:
    found = _whole("count", count, 1 << 63)
    if found == 0:
        raise ValueError("count=0 leaves no point; give at least 1")
    return len(points) if found is None else found


def greedy(
    points: object,
    *,
    count: Optional[int] = None,
    start: Optional[int] = None,
    seed: int = 0,
    normals: Optional[object] = None,
    reach: Optional[float] = None,
    progress: Optional[bool] = None,
) -> Array:
    """Each pick is the point farthest from all picks before; ties go to the lower index. Exact.

    count: at most so many picks; all points if absent.
    start: the first pick; without it, `seed` chooses one.
    normals, reach: distances along the surface, through neighbours up to `reach` apart (world units)
        that face alike, in place of straight ones.

    Raises `ValueError` for a point that is not finite.
    """
    p = _points(points)
    along = None
    if (normals is None) != (reach is None):
        raise ValueError("normals and reach belong together; give both, or neither")
    if normals is not None and reach is not None:
        n = float32("normals", normals, (None, 3))
        if len(n) != len(p):
            raise ValueError(f"normals: the shape {n.shape}, but there are {len(p)} points")
        if not 0.0 < float(reach) < float("inf"):
            raise ValueError(f"reach={reach!r}; give a length above 0")
        along = (n, float(reach))
    first, number = _whole("start", start, len(p)), _whole("seed", seed, 1 << 64)
    return _ordered(p, _Sampler("greedy", _count(p, count), first, number or 0, along), progress)


def progressive(
    points: object,
    *,
    count: Optional[int] = None,
    start: Optional[int] = None,
    seed: int = 0,
    as_shipped: bool = False,
    progress: Optional[bool] = None,
) -> Array:
    """Each pick is the farthest of some random points, as in the paper.

    as_shipped: the schedule of the authors' program in place of the paper's.
    """
    p = _points(points)
    name = "progressive-as-shipped" if as_shipped else "progressive"
    first, number = _whole("start", start, len(p)), _whole("seed", seed, 1 << 64)
    return _ordered(p, _Sampler(name, _count(p, count), first, number or 0), progress)


def random(points: object, *, count: Optional[int] = None, seed: int = 0, progress: Optional[bool] = None) -> Array:
    """A random order."""
    p = _points(points)
    number = _whole("seed", seed, 1 << 64)
    return _ordered(p, _Sampler("random", _count(p, count), None, number or 0), progress)


@dataclass(frozen=True)
class Spread:
    """How evenly some of the points are spread over all, in world units.

    nearest: for each, the distance to the nearest other one.  packing: the least of them.
    covering: the largest distance from any of the points to the nearest of these.
    """

    nearest: Array = field(repr=False)
    packing: float
    covering: float


def quality(points: object, prefix: object) -> Spread:
    """How evenly the points with these indices, such as `order[:1000]`, are spread over all points."""
    p = _points(points)
    with calling(False) as how:
        nearest, packing, covering = _splatref.quality(how, p, indices("prefix", prefix, len(p)))
    return Spread(np.sqrt(nearest), float(np.sqrt(packing)), float(np.sqrt(covering)))


@dataclass(frozen=True)
class Spectrum:
    """At which frequencies points are even.

    frequency: in cycles a unit.  power: at each; 1 for random points, near 0 where they are even.
    unit: the distance of the densest packing.  reach: the distance up to which pairs count.
    density: points a square world unit.
    """

    frequency: Array = field(repr=False)
    power: Array = field(repr=False)
    reach: float
    density: float
    unit: float


def spectrum(points: object, *, progress: Optional[bool] = None) -> Spectrum:
    """The spectrum of points on a surface; at least 256."""
    p = _points(points)
    with calling(progress) as how:
        frequency, power, numbers = _splatref.spectrum(how, p)
    return Spectrum(np.array(frequency), np.array(power), *(float(one) for one in numbers))


def average_colors(
    points: object, colors: object, order: object, *, count: Optional[int] = None, progress: Optional[bool] = None
) -> Array:
    """The mean colours of the first `count` points of an order over the points nearest to each.

    Returns float32 (count, 3), in the order.
    """
    p, c = _points(points), float32("colors", colors, (None, 3))
    if len(c) != len(p):
        raise ValueError(f"colors: the shape {c.shape}, but there are {len(p)} points")
    index = indices("order", order, len(p))
    first: Any = len(index) if count is None else _whole("count", count, len(index) + 1)
    with calling(progress) as how:
        found: Array = _splatref.average_colors(how, p, c, index, first)
    return found.reshape(-1, 3)
