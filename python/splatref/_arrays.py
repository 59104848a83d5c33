"""Checks and converts what callers hand over: every array is looked at here before Rust sees it."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np
import numpy.typing as npt

from . import _splatref

Array = npt.NDArray[Any]

# How many numbers are converted at once, so that a conversion needs little memory of its own.
_CHUNK = 1 << 20
# Below this whole number, a float32 comes from one whole number only.
_WHOLE = 1 << 24


def as_array(name: str, value: object) -> Array:
    """The array that a value is, through `__array__` or DLPack; no copy where none is needed."""
    if isinstance(value, np.ma.MaskedArray):
        raise ValueError(f"{name}: a masked array; give an array with a number at each place, such as a.filled(0)")
    try:
        if not hasattr(value, "__array__") and hasattr(value, "__dlpack__"):
            array: Array = np.from_dlpack(value)
        else:
            array = np.asarray(value)
    except KeyboardInterrupt:
        raise
    except Exception as error:
        raise ValueError(f"{name}: {type(value).__name__} is no array of the CPU: {error}") from error
    if array.dtype.kind not in "fiub":
        raise ValueError(
            f"{name}: an array of {array.dtype} with the shape {array.shape}; give floats or integers"
        )
    return array


def packed(array: Array, dtype: npt.DTypeLike | None = None) -> Array:
    """The array without gaps, aligned and in the byte order of the machine: as Rust takes it."""
    wanted = np.dtype(dtype if dtype is not None else array.dtype).newbyteorder("=")
    found: Array = np.require(array, wanted, ["C_CONTIGUOUS", "ALIGNED"])
    return found


def _ask(size: int, what: str) -> None:
    """Raises `ValueError` if the process may not hold so many bytes more: arrays may claim anything."""
    _splatref.ask(min(size, (1 << 63) - 1), what)


def _fits(array: Array, shape: tuple[Optional[int], ...]) -> bool:
    return array.ndim == len(shape) and all(
        wanted is None or wanted == side for side, wanted in zip(array.shape, shape)
    )


def _words(shape: tuple[Optional[int], ...]) -> str:
    sides = ["n" if side is None else str(side) for side in shape]
    return f"({', '.join(sides)}{',' if len(sides) == 1 else ''})"


def float32(name: str, value: object, shape: tuple[Optional[int], ...]) -> Array:
    """An array of float32 with this shape, in any order in memory; `None` stands for any side.

    Other types are taken if each number is a float32, so that nothing is rounded unseen. Lists of
    Python have no type of their own: they are rounded once, as numbers of a scene file are.
    """
    array = as_array(name, value)
    if isinstance(value, (list, tuple)) and array.dtype == np.float64:
        with np.errstate(all="ignore"):
            array = array.astype(np.float32)
    if not _fits(array, shape):
        raise ValueError(f"{name}: an array with the shape {array.shape}; give {_words(shape)}")
    if array.dtype.kind == "b":
        raise ValueError(f"{name}: an array of bool with the shape {array.shape}; give float32 {_words(shape)}")
    if array.dtype == np.float32 and array.dtype.isnative and array.flags.aligned:
        return array
    _ask(array.size * 4, f"a copy of {name}")
    copy = np.empty(array.shape, np.float32)
    rows = max(1, _CHUNK // max(1, array.size // max(1, len(array))))
    for first in range(0, len(array), rows):
        part, single = array[first : first + rows], copy[first : first + rows]
        with np.errstate(all="ignore"):
            single[...] = part
        wrong = np.argwhere(~_equal(part, single))
        if len(wrong):
            place = tuple(int(i) for i in wrong[0])
            at = ", ".join(map(str, (place[0] + first, *place[1:])))
            raise ValueError(
                f"{name}: an array of {array.dtype} with the shape {array.shape}, and {part[place]!r} at "
                f"[{at}] is no float32; round the numbers yourself: {name}.astype(numpy.float32)"
            )
    return copy


def _equal(part: Array, single: Array) -> Array:
    """Where the numbers are the same."""
    if part.dtype.kind == "f":
        same: Array = (single == part) | (np.isnan(single) & np.isnan(part))
        return same
    # A float32 above 2^24 may be the neighbour of a whole number.
    back = single.astype(np.float64)
    small: Array = np.abs(back) < _WHOLE
    if bool(small.all()):
        return small
    limit = 2.0**64 if part.dtype.kind == "u" else 2.0**63
    inside = np.abs(back) < limit
    wide = np.uint64 if part.dtype.kind == "u" else np.int64
    whole = np.where(inside, back, 0).astype(wide)
    same = small | (inside & (whole == part.astype(wide)))
    return same


def indices(name: str, value: object, count: int) -> Array:
    """Indices of points as uint32."""
    array = as_array(name, value)
    if array.ndim != 1 or array.dtype.kind not in "iu":
        raise ValueError(
            f"{name}: an array of {array.dtype} with the shape {array.shape}; give whole numbers of the shape (n,)"
        )
    _ask(array.size * 4, f"a copy of {name}")
    if array.size and (int(array.min()) < 0 or int(array.max()) >= count):
        raise ValueError(f"{name}: indices from {array.min()} to {array.max()}, but there are {count} points")
    return packed(array, dtype=np.uint32)


_FORMATS = {"f2": "f16", "f4": "f32", "f8": "f32", "u1": "u8", "b1": "u8", "u2": "u16", "u4": "u32", "i4": "i32"}


def plane(name: str, value: object) -> Array:
    """A plane as (height, width) or (height, width, components).

    Channels may come first, as in tensors, and behind a batch of one picture.
    """
    array = as_array(name, value)
    if array.ndim == 4 and array.shape[0] == 1:
        array = array[0]
    if array.ndim == 3 and array.shape[-1] not in (1, 2, 3) and array.shape[0] in (1, 2, 3):
        array = np.moveaxis(array, 0, -1)
    if array.ndim == 3 and array.shape[-1] == 1:
        array = array[..., 0]
    if array.ndim not in (2, 3) or (array.ndim == 3 and array.shape[-1] not in (2, 3)) or 0 in array.shape:
        raise ValueError(
            f"{name}: an array of {array.dtype} with the shape {array.shape}; "
            "give (height, width) or (height, width, 3)"
        )
    return array


def stored_plane(name: str, value: object) -> tuple[Array, str]:
    """The numbers of a plane as float64, and the format that they were stored in."""
    array = plane(name, value)
    _ask(array.size * 32, f"the plane {name}")
    kind = array.dtype.kind + str(array.dtype.itemsize)
    if kind in ("i1", "i2"):
        return packed(array, dtype=np.float64), "i32"
    if kind in ("i8", "u8"):
        low, high = int(array.min()), int(array.max())
        if low < -1 or high > 0xFFFF_FFFF:
            raise ValueError(f"{name}: whole numbers from {low} to {high}; give numbers of 32 bits, or -1")
        if low == -1 and high < 1 << 31:
            return packed(array, dtype=np.float64), "i32"
        numbers = packed(array, dtype=np.float64)
        # As a file of 32 bits has -1: all bits set.
        return np.where(numbers == -1, np.float64(0xFFFF_FFFF), numbers), "u32"
    if kind not in _FORMATS:
        raise ValueError(f"{name}: an array of {array.dtype} with the shape {array.shape}; give float16, float32 or float64")
    return packed(array, dtype=np.float64), _FORMATS[kind]


def picture_plane(name: str, value: object) -> Array:
    """A plane of a picture to compare or write: float32, uint32 or uint8 as pictures have them."""
    array = plane(name, value)
    _ask(array.size * 8, f"a copy of {name}")
    if array.dtype.kind == "f":
        if array.dtype == np.float64 and array.dtype.isnative:
            # Pictures of f64 are rounded once, as files hold them.
            return packed(array)
        return packed(float32(name, array, array.shape))
    if array.ndim == 3:
        raise ValueError(f"{name}: an array of {array.dtype} with the shape {array.shape}; colours and vectors are floats")
    if array.dtype == np.uint8:
        return packed(array)
    numbers, _ = stored_plane(name, array)
    whole = np.where(numbers == -1, np.float64(0xFFFF_FFFF), numbers)
    if whole.min() < 0:
        raise ValueError(f"{name}: {whole.min():.0f} is no index; give whole numbers from 0, or -1 for none")
    return whole.astype(np.uint32)
