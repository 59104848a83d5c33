"""How far a picture is from a reference, in numbers that rank methods.

Each function takes two pictures, two dictionaries with "RGB", or two arrays of linear RGB
(height, width, 3). To learn whether a picture is right, use `splatref.compare` or `splatref.verify`.
"""

from __future__ import annotations

import os
from typing import Mapping, Optional, Union

import numpy as np

from . import _splatref
from ._arrays import Array, packed, picture_plane
from ._call import calling
from ._compare import planes_of
from ._picture import listed

__all__ = ["errors", "flip", "flip_map", "psnr", "rmse", "ssim"]

Colors = Union[Mapping[str, object], Array, str, "os.PathLike[str]"]


def _rgb(name: str, value: object) -> Array:
    if isinstance(value, (Mapping, str, os.PathLike)):
        planes = planes_of(value)
        if "RGB" not in planes and "rgb" not in planes:
            raise ValueError(f"{name}: no plane is called RGB; there are {', '.join(planes)}")
        value = planes["RGB"] if "RGB" in planes else planes["rgb"]
    plane = picture_plane(name, value)
    if plane.ndim != 3 or plane.shape[-1] != 3:
        raise ValueError(f"{name}: an array with the shape {plane.shape}; give linear RGB (height, width, 3)")
    return plane


def _pair(picture: object, reference: object) -> tuple[Array, Array]:
    first, second = _rgb("picture", picture), _rgb("reference", reference)
    if first.shape != second.shape:
        raise ValueError(f"picture: the shape {first.shape}, but the reference has {second.shape}")
    return first.astype(np.float32), second.astype(np.float32)


def rmse(picture: Colors, reference: Colors) -> float:
    """The root of the mean squared difference over the three channels."""
    first, second = _pair(picture, reference)
    means = [np.mean((first[..., i].astype(np.float64) - second[..., i]) ** 2) for i in range(3)]
    return float(np.sqrt(np.mean(means)))


def psnr(picture: Colors, reference: Colors) -> float:
    """20 log10(1 / RMSE), in decibels; inf for equal pictures."""
    error = rmse(picture, reference)
    return float("inf") if error == 0.0 else float(-20.0 * np.log10(error))


def ssim(picture: Colors, reference: Colors) -> float:
    """The mean structural similarity of the three channels, at most 1 [WBSS04].

    Raises `ValueError` if a side is below 11 pixels.
    """
    first, second = _pair(picture, reference)
    total = 0.0
    for i in range(3):
        with calling(False) as how:
            one = _splatref.ssim(how, packed(first[..., i]), packed(second[..., i]))
        if one is None:
            raise ValueError(f"picture: the shape {first.shape} is too small for SSIM; give 11 pixels a side or more")
        total += float(one)
    return total / 3.0


def flip(picture: Colors, reference: Colors, *, pixels_per_degree: float = 67.0) -> float:
    """The mean of FLIP, 0 where nothing is seen, at most 1 [ANA+20].

    pixels_per_degree: of the visual angle, 1 to 1000.
    """
    return _flip(picture, reference, pixels_per_degree)[0]


def flip_map(picture: Colors, reference: Colors, *, pixels_per_degree: float = 67.0) -> Array:
    """FLIP of each pixel, float32 (height, width)."""
    return _flip(picture, reference, pixels_per_degree)[1]


def _flip(picture: object, reference: object, pixels_per_degree: float) -> tuple[float, Array]:
    first, second = _pair(picture, reference)
    with calling(False) as how:
        mean, found = _splatref.flip(how, ([("RGB", first)], [("RGB", second)]), float(pixels_per_degree))
    return float(mean), found


def errors(
    picture: Union[Mapping[str, object], str, "os.PathLike[str]"],
    truth: Union[Mapping[str, object], str, "os.PathLike[str]"],
) -> dict[str, Optional[float]]:
    """Every error of a picture against its truth: colours, holes, outline, depth and normals.

    Both have the planes RGB, A, Z and, where there is one, normal. `None` where there is nothing to
    measure.
    """
    pair = (listed(planes_of(picture)), listed(planes_of(truth)))
    with calling(False) as how:
        return {name: value for name, _, _, value in _splatref.errors(how, pair)}
