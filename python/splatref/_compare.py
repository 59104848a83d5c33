"""Comparisons of pictures, plane by plane."""

from __future__ import annotations

import os
from typing import Any, Mapping, Optional, Sequence, Union

from . import _splatref
from ._call import calling
from ._picture import Planes, listed, read
from ._scene import Path

Planar = Union[Mapping[str, object], Path]

_Bounds = tuple[Optional[int], Optional[float], int]


class Comparison:
    """How two pictures differ.

    verdict: "equal" (every bit), "within" the tolerance, or "different".
    equal: whether every bit is equal.  passed: whether it is equal or within the tolerance.
    channels: one dictionary for each channel of either picture: name, verdict, line, and where both
        have it pixels, differing, failing, nan, max_ulp, max_abs, rms, and the first and the worst
        pixel as ((column, row), value, other value).
    """

    def __init__(self, verdict: str, lines: list[str], channels: list[dict[str, Any]]) -> None:
        self.verdict = verdict
        self.equal = verdict == "equal"
        self.passed = verdict != "different"
        self.channels = channels
        self._lines = lines

    def __getitem__(self, channel: str) -> dict[str, Any]:
        for one in self.channels:
            if one["name"] == channel:
                return one
        raise KeyError(f"no channel is called {channel!r}")

    def __str__(self) -> str:
        return "\n".join(self._lines)

    def __repr__(self) -> str:
        return f"<Comparison: {self._lines[-1]}>"


def _bounds(name: str, given: Mapping[str, object]) -> _Bounds:
    unknown = set(given) - {"ulp", "abs", "pixels"}
    if unknown:
        raise ValueError(f"{name}: {sorted(unknown)[0]!r}; a tolerance has ulp, abs and pixels")
    ulp, most, pixels = given.get("ulp"), given.get("abs"), given.get("pixels", 0)
    for key, value in (("ulp", ulp), ("pixels", pixels)):
        if value is not None and not (isinstance(value, int) and 0 <= value < 1 << 32):
            raise ValueError(f"{name}: {key}={value!r}; give a whole number from 0")
    if most is not None and not (isinstance(most, (int, float)) and most >= 0):
        raise ValueError(f"{name}: abs={most!r}; give a number from 0")
    return ulp, most, pixels  # type: ignore[return-value]


def planes_of(value: Planar) -> Mapping[str, object]:
    """The planes of a picture, a dictionary or a file."""
    if isinstance(value, (str, os.PathLike)):
        return read(value)
    return value


def compare(
    reference: Planar,
    picture: Planar,
    *,
    planes: Optional[Sequence[str]] = None,
    max_ulp: Optional[int] = None,
    max_abs: Optional[float] = None,
    tolerance: Optional[Mapping[str, Mapping[str, object]]] = None,
    progress: Optional[bool] = None,
) -> Comparison:
    """Compares a picture with a reference: pictures, dictionaries of planes, or files.

    planes: compare only these: "Z", "normal" (its three channels), "visibility.*", "R".
    max_ulp, max_abs: accept floats at most so many representable numbers, or so much, apart.
    tolerance: bounds of single planes: {"Z": {"ulp": 4, "abs": 1e-6, "pixels": 3}}; so many pixels
        may exceed the bounds.

    Without bounds every bit must be equal. A plane `margin` that only the reference has is left out.
    Raises `ValueError` for a plane that does not exist.
    """
    named = [(name, _bounds(f"tolerance[{name!r}]", one)) for name, one in (tolerance or {}).items()]
    all_planes = _bounds("compare", {"ulp": max_ulp, "abs": max_abs})
    pair = (listed(planes_of(reference)), listed(planes_of(picture)))
    wanted = None if planes is None else list(planes)
    with calling(progress) as how:
        found = _splatref.compare(how, pair, wanted, all_planes, named)
    return Comparison(*found)


def sha256(pictures: Mapping[str, Mapping[str, object]]) -> str:
    """One hash of the planes of named pictures, in this order, as `splatref golden` prints it."""
    return str(_splatref.sha256([(name, listed(planes)) for name, planes in pictures.items()]))


__all__ = ["Comparison", "Planes", "compare", "sha256"]
