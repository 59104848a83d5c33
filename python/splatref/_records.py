"""Projected splats as structured arrays: a reference for projections, and a renderer's own for `verify`."""

from __future__ import annotations

from typing import Any, Mapping, Optional

import numpy as np

from . import _splatref
from ._arrays import Array, as_array, float32, indices
from ._call import calling
from ._picture import _rust
from ._scene import AnyCamera, Scene, choice_of
from ._text import choices

_TYPES = {"f32": "<f4", "u32": "<u4"}


def project(
    scene: Scene,
    camera: Optional[AnyCamera] = None,
    *,
    method: Optional[str] = None,
    frame: Optional[int] = None,
    progress: Optional[bool] = None,
    **settings: object,
) -> Array:
    """Projects the visible splats of a scene, in float32. Arguments are those of `render`.

    Returns a structured array of one record for each visible splat: surfels in ascending index, Gaussians in
    the order of blending. Its bytes are those that `splatref project` writes, and those that a shader reads.
    Gaussians have the fields place, key, color, alpha, conic, compensation, ellipse, distance, unfiltered,
    index, covariance, center and bounds; surfels have center, conic, plane, range, amplitude, surfel, bounds,
    normal, opacity, color and back. The documentation of `GaussianRecord` and `SplatRecord` gives their units.

    Raises `ValueError` if the method draws no splats.
    """
    chosen = choices("project", method, settings, frame)
    with calling(progress) as how:
        numbers = _splatref.project(how, _rust(scene), choice_of(camera), chosen)
    found: Array = numbers.view(_dtype(scene, chosen))
    return found


def _dtype(scene: Scene, chosen: Any) -> np.dtype[Any]:
    """The type of a record of the chosen method."""
    layout = _splatref.record_layout(_rust(scene), chosen)
    if layout is None:
        raise ValueError("records: this method draws no splats; leave out its records, or give another method")
    size, fields = layout
    formats = []
    for _, _, kind in fields:
        word, _, count = kind.partition(" x ")
        formats.append((_TYPES[word], int(count)) if count else _TYPES[word])
    names, offsets = [field[0] for field in fields], [field[1] for field in fields]
    return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": size})


def packed_records(value: object, scene: Scene, chosen: Any) -> bytes:
    """A renderer's records as the bytes of a file of records."""
    wanted = _dtype(scene, chosen)
    names = wanted.names or ()
    columns: Mapping[str, object]
    if isinstance(value, Mapping):
        columns = value
    elif isinstance(value, np.ndarray) and value.dtype.names and value.ndim == 1:
        columns = {name: value[name] for name in value.dtype.names}
    else:
        raise ValueError("records: give a structured array as `project` returns it, or a dictionary of arrays")
    missing = [name for name in names if name not in columns]
    unknown = [name for name in columns if name not in names]
    if missing or unknown:
        what = f"without {', '.join(missing)}" if missing else f"with {', '.join(map(repr, unknown))}"
        raise ValueError(f"records: {what}; give the fields {', '.join(names)}")
    first = as_array(f"records[{names[0]!r}]", columns[names[0]])
    count = len(first) if first.ndim else 0
    # Here, as bytes for Rust, and as records there.
    _splatref.ask(3 * count * wanted.itemsize, "copies of records")
    rows = np.zeros(count, wanted)
    for name in names:
        field, label = wanted[name], f"records[{name!r}]"
        shape = (count, *field.shape)
        if field.base.kind == "f":
            rows[name] = float32(label, columns[name], shape)
        else:
            whole = as_array(label, columns[name])
            if whole.shape != shape:
                raise ValueError(f"{label}: an array with the shape {whole.shape}; give {shape}")
            rows[name] = indices(label, whole.reshape(-1), 1 << 32).reshape(shape)
    return rows.tobytes()
