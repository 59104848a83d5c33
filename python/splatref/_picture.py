"""Pictures: rendered, read, written and explained."""

from __future__ import annotations

import os
from typing import Any, Iterator, Mapping, Optional, Sequence, Union, overload

import numpy as np

from . import _splatref
from ._arrays import Array, picture_plane
from ._call import calling
from ._scene import AnyCamera, Camera, Path, ResolvedCamera, Scene, choice_of
from ._text import choices


class Planes(Mapping[str, Array]):
    """Named planes of one size: arrays of (height, width) or (height, width, 3), rows from the top.

    "RGB" is the picture, linear and not clipped; the colour of a stage is "attributes.RGB", and
    "attributes" finds it too. `==` compares by identity; `compare` compares numbers.
    """

    __eq__ = object.__eq__
    __hash__ = object.__hash__

    def __init__(self, planes: Mapping[str, Array]) -> None:
        self._planes = dict(planes)

    def __getitem__(self, name: str) -> Array:
        for known in (name, f"{name}.RGB", "RGB" if name.lower() == "rgb" else name):
            if known in self._planes:
                return self._planes[known]
        raise KeyError(f"no plane is called {name!r}; there are {', '.join(self._planes)}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._planes)

    def __len__(self) -> int:
        return len(self._planes)

    def __contains__(self, name: object) -> bool:
        try:
            return isinstance(name, str) and self[name] is not None
        except KeyError:
            return False

    @property
    def size(self) -> tuple[int, int]:
        """(width, height) in pixels."""
        height, width = next(iter(self._planes.values())).shape[:2]
        return width, height

    def to_png(self, path: Path) -> None:
        """Writes a preview of 8 bits in sRGB, for people to look at.

        Raises `ValueError` without a plane RGB, `OSError` if the file cannot be written.
        """
        if "RGB" not in self._planes:
            raise ValueError("a PNG shows the plane RGB, and there is none")
        with calling(False) as how:
            _splatref.save_png(how, os.fspath(path), listed(self))

    def _repr_png_(self) -> Optional[bytes]:
        if "RGB" not in self._planes:
            return None
        shown: list[tuple[str, Array]] = [(name, self._planes[name]) for name in ("RGB", "A") if name in self._planes]
        png: Optional[bytes] = _splatref.png(shown)
        return png

    def __repr__(self) -> str:
        width, height = self.size
        return f"<{type(self).__name__} {width} x {height}: {', '.join(self._planes)}>"


class Picture(Planes):
    """A rendered picture: its planes, and how it was made.

    Planes are float32, or float64 with number="f64"; ids are uint32 (`NO_ID` where nothing is) and
    counts uint8. `methods.planes(method)` says what each plane holds.
    """

    def __init__(self, planes: Mapping[str, Array], drawn: Any) -> None:
        super().__init__(planes)
        self._drawn = drawn

    @property
    def camera(self) -> ResolvedCamera:
        """The camera that drew it."""
        return ResolvedCamera._of(self._drawn.camera)

    @property
    def method(self) -> str:
        """The name of the method."""
        return str(self._drawn.method)

    @property
    def settings(self) -> dict[str, str]:
        """The settings of the method, and what they give in this scene."""
        return dict(self._drawn.settings)

    @property
    def times(self) -> dict[str, float]:
        """Seconds of each stage. Stages that run as one loop have one entry: `blending and averaging`."""
        times: dict[str, float] = {}
        for stage, seconds in self._drawn.times:
            times[stage] = times.get(stage, 0.0) + seconds
        return times

    @property
    def tally(self) -> dict[str, int]:
        """How many surfels were drawn, and how many were not, and why."""
        return dict(self._drawn.tally)

    @property
    def region(self) -> tuple[int, int, int, int]:
        """The columns and rows that the planes hold: x0, y0, x1, y1, the ends excluded."""
        x0, y0, x1, y1 = self._drawn.window[0]
        return x0, y0, x1, y1

    @property
    def state(self) -> Optional[Any]:
        """What the frame saw, for `render(..., state=...)` of the next frame; only of deferred."""
        return self._drawn.state

    @property
    def text(self) -> str:
        """The text that the EXR carries: the scene, the camera and every setting."""
        with calling(False) as how:
            return str(self._drawn.text(how))

    def save(self, path: Path, *, compression: Optional[str] = None) -> None:
        """Writes every plane into an .exr, without loss, as the program does.

        compression: as the setting of this name; the picture's own if absent.

        The file is complete or absent. Raises `ValueError` for another kind of file, `OSError` if it
        cannot be written.
        """
        path = os.fspath(path)
        if not path.lower().endswith(".exr"):
            raise ValueError(f"{path}: a picture is written as an EXR; give a name that ends in .exr")
        with calling(False) as how:
            text = self._drawn.text(how)
            kind = compression or self._drawn.compression
            _splatref.save_exr(how, path, listed(self), text, kind, self._drawn.window)


def listed(planes: Mapping[str, object]) -> list[tuple[str, Array]]:
    """Planes as Rust takes them."""
    if not isinstance(planes, Mapping):
        raise TypeError(f"{type(planes).__name__}: give a picture, or a dictionary of planes by name")
    names = {"rgb": "RGB"}
    found = [(names.get(name, name), picture_plane(name, value)) for name, value in planes.items()]
    if not found:
        raise ValueError("no planes; give at least one")
    return found


def save_planes(path: Path, planes: Mapping[str, object]) -> None:
    """Writes planes that no picture has, without a text."""
    with calling(False) as how:
        _splatref.save_exr(how, os.fspath(path), listed(planes), "", "zip", None)


def read(path: Path) -> Planes:
    """Reads every plane of an .exr, an .npy or an .npz.

    Raises `OSError` if the file cannot be read, `ValueError` if it is damaged or of another kind.
    """
    path = os.fspath(path)
    name = os.path.splitext(os.path.basename(path))[0]
    with calling(False) as how:
        channels, _ = _splatref.read(how, path, name)
    found = dict(channels)
    planes: dict[str, Array] = {}
    for channel in found:
        layer, letter = channel.rpartition(".")[::2]
        dot = f"{layer}." if layer else ""
        for letters, plane in (("RGB", f"{dot}RGB"), ("XYZ", layer)):
            three = [dot + one for one in letters]
            if letter in letters and plane and all(one in found for one in three):
                if letter == letters[0]:
                    planes[plane] = np.stack([found[one] for one in three], axis=-1)
                break
        else:
            planes[channel] = found[channel]
    return Planes(planes)


@overload
def render(
    scene: Scene,
    camera: Optional[AnyCamera] = ...,
    *,
    method: Optional[str] = ...,
    frame: Optional[int] = ...,
    state: Optional[Any] = ...,
    region: Optional[tuple[int, int, int, int]] = ...,
    progress: Optional[bool] = ...,
    **settings: object,
) -> Picture: ...


@overload
def render(
    scene: Scene,
    camera: Sequence[AnyCamera],
    *,
    method: Optional[str] = ...,
    frame: Optional[int] = ...,
    state: Optional[Any] = ...,
    region: Optional[tuple[int, int, int, int]] = ...,
    progress: Optional[bool] = ...,
    **settings: object,
) -> list[Picture]: ...


def render(
    scene: Scene,
    camera: Union[AnyCamera, Sequence[AnyCamera], None] = None,
    *,
    method: Optional[str] = None,
    frame: Optional[int] = None,
    state: Optional[Any] = None,
    region: Optional[tuple[int, int, int, int]] = None,
    progress: Optional[bool] = None,
    **settings: object,
) -> Union[Picture, list[Picture]]:
    """Renders a scene.

    camera: a `Camera`; the scene's own if absent. Of a list of cameras you get a list of pictures,
        and the method prepares the scene once.
    method: "ewa" and so on; the scene file's own, or "ewa", if absent. `methods()` lists them.
    frame: the frame of a sequence, from 0.
    state: the `state` of the picture before, for the method deferred.
    region: (x0, y0, x1, y1) draws these columns and rows alone, x1 and y1 excluded, with the bits of the
        whole picture. The planes have the size of the region, and so has the data window of the file.
        The methods pyramid and template need the whole picture: of a region you get the planes of the
        projection alone. Save all parts, and join them with `splatref assemble`; or use `cluster.render`.
    progress: False for no progress bar; shown in a terminal and in a notebook if tqdm is there.
    settings: the settings of the method, its groups and the picture, by the names of the command
        line with _ for -: `epsilon="1.5r"`, `cull=False`, `number="f64"`, `stages=True`. Their units,
        ranges and defaults: `settings(method)`.

    The bits of a picture depend on scene, camera, settings and number alone. Raises `ValueError` for
    settings out of range, `TypeError` for settings that do not exist.
    """
    several = isinstance(camera, Sequence)
    cameras: list[Any] = list(camera) if isinstance(camera, Sequence) else [camera]
    if not cameras:
        raise ValueError("camera: an empty list; give at least one camera")
    chosen = choices("render", method, settings, frame)
    with calling(progress) as how:
        found = _splatref.render(
            how, _rust(scene), [choice_of(one) for one in cameras], chosen, state, region_of(region)
        )
    pictures = [Picture(dict(planes), drawn) for planes, drawn in found]
    return pictures if several else pictures[0]


def render_one(
    how: Any,
    scene: Scene,
    camera: Optional[AnyCamera],
    chosen: Any,
    region: Optional[list[int]] = None,
    state: Optional[Any] = None,
) -> Any:
    """A picture or a region of it, as Rust returns it."""
    return _splatref.render(how, _rust(scene), [choice_of(camera)], chosen, state, region)[0]


def explain(
    scene: Scene,
    camera: Optional[AnyCamera],
    pixel: tuple[int, int],
    *,
    method: Optional[str] = None,
    frame: Optional[int] = None,
    progress: Optional[bool] = None,
    **settings: object,
) -> str:
    """Every decision at a pixel (column, row), in words. Arguments are those of `render`."""
    chosen = choices("explain", method, settings, frame)
    with calling(progress) as how:
        return str(_splatref.explain(how, _rust(scene), choice_of(camera), chosen, pixel_of(pixel)))


def truth(
    scene: Scene,
    camera: Optional[AnyCamera] = None,
    *,
    frame: Optional[int] = None,
    progress: Optional[bool] = None,
    **settings: object,
) -> Planes:
    """The true picture of a scene, to measure errors against: RGB, A, Z and normal.

    Shapes and meshes are met exactly by 8 x 8 rays a pixel; of points alone the truth is EWA in f64
    at 8 x 8 times the pixels. `cull=False` shows back faces.
    """
    chosen = choices("truth", None, settings, frame)
    with calling(progress) as how:
        planes, _ = _splatref.truth(how, _rust(scene), choice_of(camera), chosen)
    return Planes(dict(planes))


def region_of(region: Optional[tuple[int, int, int, int]]) -> Optional[list[int]]:
    """A region as Rust takes it."""
    if region is None:
        return None
    try:
        x0, y0, x1, y1 = (int(one) for one in region)
    except (TypeError, ValueError):
        raise ValueError(f"region: {region!r}; give (x0, y0, x1, y1), x1 and y1 excluded") from None
    if not (0 <= x0 < x1 < 1 << 32 and 0 <= y0 < y1 < 1 << 32):
        raise ValueError(f"region: {region!r} has no pixel; give x1 above x0 and y1 above y0, from 0")
    return [x0, y0, x1, y1]


def pixel_of(pixel: tuple[int, int]) -> tuple[int, int]:
    """A pixel as Rust takes it."""
    try:
        x, y = (int(one) for one in pixel)
    except (TypeError, ValueError):
        raise ValueError(f"pixel: {pixel!r}; give (column, row)") from None
    if not (0 <= x < 1 << 32 and 0 <= y < 1 << 32):
        raise ValueError(f"pixel: {pixel!r} is outside the picture")
    return x, y


def _rust(scene: object) -> Any:
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: {type(scene).__name__}; give a splatref.Scene, such as Scene.open('sphere')")
    return scene._rust


__all__ = ["Camera", "Picture", "Planes", "explain", "read", "render", "truth"]
