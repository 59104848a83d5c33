"""Scenes and cameras."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Iterable, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _splatref
from ._arrays import Array, as_array, float32
from ._call import calling
from ._text import Choices, table, toml

Path = Union[str, "os.PathLike[str]"]
Numbers = Union[Sequence[float], npt.NDArray[Any]]


class Camera:
    """A camera: where it stands, where it looks, and how wide it sees.

    Give a pose by `eye`, `target` and `up`, or by a matrix with its `convention`, and a lens by `K`,
    `fov`, `focal` or `ortho`. What you leave out is chosen so that the scene is seen.

    size: (width, height) in pixels; 1024 x 768 if absent.
    K: 3 x 3 intrinsics in pixels of this size, without skew; the centre of the first pixel is (0.5, 0.5).
    world_to_camera, camera_to_world: a 3 x 4 or 4 x 4 matrix that multiplies columns.
    convention: "opencv" (+y down, +z forward), "opengl" or "blender" (+y up, -z forward); for a
        projection_matrix "opengl", "vulkan" or "d3d".
    projection_matrix: 4 x 4, in place of the lens, beside a pose.
    eye, target, up: three numbers each, in world units.
    fov: the vertical field of view in degrees, above 0 and below 180.
    focal: the focal length in pixels.  ortho: the height of the picture in world units.
    near: the depth of the near plane.
    file, view: a transforms.json, a COLMAP folder or an .exr, and the name or number of a view.
    turntable: the number of frames of one turn around the scene.
    stereo, stereo_eye: the distance between the eyes of a stereo pair, and the eye to draw, "left" or
        "right". Both eyes draw the same surfels, which the camera in the middle chooses.

    Raises `ValueError` for numbers that make no camera, and `OSError` for files that cannot be read.

    >>> Camera(eye=(0, 0, 4), target=(0, 0, 0), fov=40, size=(320, 240))
    Camera(size=(320, 240), eye=(0, 0, 4), target=(0, 0, 0), fov=40)
    """

    def __init__(
        self,
        *,
        size: Optional[tuple[int, int]] = None,
        K: Optional[object] = None,
        world_to_camera: Optional[object] = None,
        camera_to_world: Optional[object] = None,
        projection_matrix: Optional[object] = None,
        convention: Optional[str] = None,
        eye: Optional[Numbers] = None,
        target: Optional[Numbers] = None,
        up: Optional[Numbers] = None,
        fov: Optional[float] = None,
        focal: Optional[float] = None,
        ortho: Optional[float] = None,
        near: Optional[float] = None,
        far: Optional[float] = None,
        file: Optional[Path] = None,
        view: Optional[Union[str, int]] = None,
        turntable: Optional[int] = None,
        stereo: Optional[float] = None,
        stereo_eye: Optional[str] = None,
    ) -> None:
        given: dict[str, object] = {
            "size": size,
            "K": K,
            "world_to_camera": world_to_camera,
            "camera_to_world": camera_to_world,
            "projection_matrix": projection_matrix,
            "convention": convention,
            "eye": eye,
            "target": target,
            "up": up,
            "fov": fov,
            "focal": focal,
            "ortho": ortho,
            "near": near,
            "far": far,
            "file": file,
            "view": view,
            "turntable": turntable,
            "stereo": stereo,
            "stereo_eye": stereo_eye,
        }
        self._given = {name: value for name, value in given.items() if value is not None}
        keys: dict[str, object] = dict(given)
        if K is not None:
            if size is None:
                raise ValueError("Camera: K is in pixels of a picture; give its size too")
            keys.update(_intrinsics(K))
        del keys["K"]
        for name in ("world_to_camera", "camera_to_world", "projection_matrix"):
            if keys[name] is not None:
                keys[name] = _matrix(name, keys[name])
        self._choice = _splatref.CameraChoice(table("camera", keys))

    @staticmethod
    def all(file: Path, **more: Any) -> list[Camera]:
        """Every camera of a transforms.json, a COLMAP folder or an .exr that splatref wrote.

        `more` are arguments of `Camera`, such as `size` or `near`.
        """
        return [Camera(file=file, view=view, **more) for view in range(_splatref.views(os.fspath(file)))]

    def __reduce__(self) -> tuple[Any, ...]:
        return _camera_of, (self._given,)

    def __repr__(self) -> str:
        return f"Camera({', '.join(f'{name}={value!r}' for name, value in self._given.items())})"


def _camera_of(given: dict[str, Any]) -> Camera:
    return Camera(**given)


def _intrinsics(K: object) -> dict[str, object]:
    k = _matrix("K", K, ((3, 3),))
    if k[0][1] != 0.0:
        raise ValueError(f"Camera: K has skew {k[0][1]}; splatref draws without skew, so give 0")
    if [k[1][0], *k[2]] != [0.0, 0.0, 0.0, 1.0]:
        raise ValueError("Camera: K is no matrix [fx 0 cx; 0 fy cy; 0 0 1]; give it by rows")
    return {"fx": k[0][0], "fy": k[1][1], "cx": k[0][2], "cy": k[1][2]}


def _matrix(name: str, value: object, shapes: tuple[tuple[int, int], ...] = ((4, 4), (3, 4))) -> list[list[float]]:
    array = as_array(name, value)
    if array.shape not in shapes or array.dtype.kind == "b":
        wanted = " or ".join(map(str, shapes))
        raise ValueError(f"{name}: an array of {array.dtype} with the shape {array.shape}; give numbers {wanted}")
    rows: list[list[float]] = array.astype(np.float64).tolist()
    return rows


@dataclass(frozen=True, eq=False)
class ResolvedCamera:
    """All numbers of a camera that drew a picture; another call takes it as its camera, bit for bit.

    size: (width, height) in pixels.  near: the depth of the near plane.
    K: 3 x 3 intrinsics in pixels; the centre of the first pixel is (0.5, 0.5). Under an orthographic
        camera it has pixels per world unit.
    world_to_camera: 4 x 4, opencv: +x right, +y down, +z forward.
    eye: the place of the camera.  perspective: whether it is no orthographic camera.
    """

    size: tuple[int, int]
    K: Array
    world_to_camera: Array
    eye: Array
    near: float
    perspective: bool
    _text: str

    @staticmethod
    def _of(numbers: Mapping[str, Any]) -> ResolvedCamera:
        k = np.array([[numbers["fx"], 0, numbers["cx"]], [0, numbers["fy"], numbers["cy"]], [0, 0, 1]])
        view = np.array(numbers["view_from_world"], dtype=np.float64)
        offset = np.eye(4)
        offset[:3, 3] = -np.array(numbers["offset"])
        world_to_camera = np.diag([1.0, -1.0, -1.0, 1.0]) @ view @ offset
        return ResolvedCamera(
            tuple(numbers["size"]),
            k,
            world_to_camera + 0.0,
            np.array(numbers["eye"]),
            numbers["near"],
            numbers["perspective"],
            numbers["text"],
        )

    @property
    def _choice(self) -> Any:
        return _splatref.CameraChoice("[camera]\n" + self._text)


AnyCamera = Union[Camera, ResolvedCamera]


def choice_of(camera: Optional[object]) -> Any:
    """What Rust takes for a camera; `None` stands for the scene's own."""
    if camera is None:
        return None
    if isinstance(camera, (Camera, ResolvedCamera)):
        return camera._choice
    raise TypeError(f"camera: {type(camera).__name__}; give a splatref.Camera, or None for the scene's own")


@dataclass
class _Points:
    """What the Rust side reads of arrays."""

    positions: Array
    normals: Optional[Array]
    radii: Optional[Array]
    colors: Optional[Array]
    opacities: Optional[Array]
    tangents: Optional[Array]


@dataclass
class _Splats:
    """What the Rust side reads of arrays of Gaussians."""

    positions: Array
    scales: Array
    rotations: Array
    opacities: Array
    harmonics: Array
    degree: int
    linear: bool


class Scene:
    """Surfels, lights and an environment.

    `Scene.open` takes what the program takes: a shape, a PLY, an OBJ, a scene TOML or a folder. The
    constructor takes arrays, all of n points:

    positions: (n, 3) in world units; not finite ones are dropped.
    normals: (n, 3), of any length; derived from neighbours if absent.
    radii: (n,) in world units, above 0; derived from neighbours if absent. A number holds for all.
    colors: (n, 3) linear RGB, not multiplied by the opacity, from 0; grey if absent.
    opacities: (n,) from 0 to 1; opaque if absent.
    tangents: (n, 2, 3), the half axes of elliptical surfels, in place of radii and normals.
    lights: a list of tables of a scene file, such as `{"kind": "point", "position": [4, 4, 4]}`; []
        for unlit colours; one headlight if absent.
    material: a table of a scene file, such as `{"specular": 0}`.
    environment: "sky" or the name of a latitude-longitude .exr.
    name: in reports and files.

    float32 arrays of any strides are copied once; arrays of other types are taken if each number is a
    float32, and lists are rounded once.
    Arrays are never changed, and later changes of them do not change the scene.

    Raises `ValueError`, which names the array, and `MemoryError`.
    """

    _rust: Any

    def __init__(
        self,
        positions: object,
        *,
        normals: Optional[object] = None,
        radii: Optional[object] = None,
        colors: Optional[object] = None,
        opacities: Optional[object] = None,
        tangents: Optional[object] = None,
        lights: Optional[Iterable[Mapping[str, object]]] = None,
        material: Optional[Mapping[str, object]] = None,
        environment: Optional[Path] = None,
        name: str = "arrays",
        progress: Optional[bool] = None,
    ) -> None:
        if isinstance(positions, (str, os.PathLike)):
            raise ValueError(f"positions: {positions!r} is a name; give it to Scene.open")
        p = float32("positions", positions, (None, 3))
        n = len(p)
        if not 0 < n < 0xFFFF_FFFF:
            raise ValueError(f"positions: an array with the shape {p.shape}; give 1 to 2^32 - 2 points")

        def of(what: str, value: Optional[object], *sides: int) -> Optional[Array]:
            if value is None:
                return None
            if not sides and np.ndim(as_array(what, value)) == 0:
                return np.broadcast_to(float32(what, [value], (1,)), (n,))
            array = as_array(what, value)
            if array.ndim > 0 and array.shape[1:] == sides and len(array) != n:
                raise ValueError(f"{what}: an array with the shape {array.shape}, but there are {n} positions")
            return float32(what, array, (n, *sides))

        points = _Points(
            p,
            of("normals", normals, 3),
            of("radii", radii),
            of("colors", colors, 3),
            of("opacities", opacities),
            of("tangents", tangents, 2, 3),
        )
        shown = None if lights is None else list(lights)
        text = _surroundings(shown or [], material, environment)
        with calling(progress) as how:
            self._rust = _splatref.Scene.arrays(how, text, shown == [], name, points)

    @classmethod
    def gaussians(
        cls,
        positions: object,
        *,
        scales: object,
        rotations: object,
        opacities: object,
        harmonics: object,
        linear: bool = False,
        environment: Optional[Path] = None,
        surface: Optional[Path] = None,
        name: str = "arrays",
        progress: Optional[bool] = None,
    ) -> Scene:
        """3D Gaussians from arrays, for the method "gaussians"; all of n Gaussians.

        positions: (n, 3) in world units.
        scales: (n, 3), standard deviations, not logarithms.
        rotations: (n, 4), quaternions x, y, z, w of any length. From w, x, y, z: `quats[:, [1, 2, 3, 0]]`.
        opacities: (n,) from 0 to 1, not logits.
        harmonics: (n, k, 3), the k = 1, 4, 9 or 16 coefficients of degree 0 to 3.
        linear: whether colours are linear light; else they are sRGB, as programs train them.
        surface: the name of an .exr with the depths Z and the colours of opaque geometry, drawn from the
            camera of the picture, that the splats are mixed with.
        environment, name: as for surfels.

        Raises `ValueError`, which names the array, and `MemoryError`.
        """
        p = float32("positions", positions, (None, 3))
        n = len(p)
        h = float32("harmonics", harmonics, (n, None, 3))
        if n == 0 or h.shape[1] not in (1, 4, 9, 16):
            raise ValueError(f"harmonics: an array with the shape {h.shape}; give 1, 4, 9 or 16 coefficients each")
        splats = _Splats(
            p,
            float32("scales", scales, (n, 3)),
            float32("rotations", rotations, (n, 4)),
            float32("opacities", opacities, (n,)),
            h.reshape(-1, 3),
            (1, 4, 9, 16).index(h.shape[1]),
            linear,
        )
        text = "" if surface is None else f"surface = {toml('surface', os.path.abspath(os.fspath(surface)))}\n"
        text += _surroundings([], None, environment)
        with calling(progress) as how:
            return cls._of(_splatref.Scene.of_gaussians(how, text, name, splats))

    @classmethod
    def open(
        cls,
        name: Path,
        *,
        count: Optional[int] = None,
        seed: Optional[int] = None,
        progress: Optional[bool] = None,
    ) -> Scene:
        """Opens a .ply, an .obj, a scene .toml, a folder of surfels, or a shape by its name.

        count: about so many surfels of a shape, or leaves of a tree.  seed: its random seed.

        Raises `OSError` if a file cannot be read, `ValueError` if it is not what it should be.
        """
        with calling(progress) as how:
            return cls._of(_splatref.Scene.open(how, os.fspath(name), count, seed, False))

    @classmethod
    def _in_parts(cls, name: Path) -> Scene:
        """A scene that can only be drawn: each picture reads what it shows of a folder of blocks."""
        with calling(None) as how:
            return cls._of(_splatref.Scene.open(how, os.fspath(name), None, None, True))

    @classmethod
    def parse(cls, text: str, *, folder: Path = ".", name: str = "scene", progress: Optional[bool] = None) -> Scene:
        """Reads the text of a scene file; the files that it names are relative to `folder`."""
        with calling(progress) as how:
            return cls._of(_splatref.Scene.parse(how, text, os.path.join(os.fspath(folder), f"{name}.toml")))

    @classmethod
    def _of(cls, rust: Any) -> Scene:
        scene = cls.__new__(cls)
        scene._rust = rust
        if rust.warnings:
            import warnings

            for what in rust.warnings:
                warnings.warn(what, stacklevel=3)
        return scene

    @property
    def name(self) -> str:
        """The name in reports and files."""
        return str(self._rust.name)

    @property
    def count(self) -> int:
        """The number of surfels or Gaussians; of a scene of objects, those of all objects."""
        return int(self._rust.surfels)

    @property
    def frames(self) -> int:
        """The number of frames."""
        return int(self._rust.frames)

    @property
    def bounds(self) -> tuple[Array, float]:
        """The middle and the radius of a sphere around the scene, in world units."""
        middle, radius = self._rust.bounds
        return np.array(middle), float(radius)

    @property
    def median_radius(self) -> float:
        """The lower median of the radii, the unit of settings such as "1.5r"."""
        return float(self._rust.median_radius)

    @property
    def dropped(self) -> str:
        """Which points could not be surfels, in words; empty if all could."""
        return str(self._rust.dropped)

    @property
    def surfels(self) -> dict[str, Array]:
        """The arrays of the surfels as they are drawn: positions, normals, radii, colors and so on."""
        return dict(self._rust.surfel_arrays())

    def camera(self, camera: Optional[AnyCamera] = None, *, frame: Optional[int] = None) -> ResolvedCamera:
        """All numbers of a camera as it sees this scene; without one, those of the scene's own camera."""
        with calling(False) as how:
            numbers = _splatref.resolve(how, self._rust, choice_of(camera), Choices(None, [], frame))
        return ResolvedCamera._of(numbers)

    def __repr__(self) -> str:
        return f"<Scene {self.name}: {self.count} surfels>"


def _surroundings(
    lights: Iterable[Mapping[str, object]],
    material: Optional[Mapping[str, object]],
    environment: Optional[Path],
) -> str:
    """The lights, the material and the environment as a scene file."""
    text = "".join(table_of_light(light) for light in lights)
    text += table("material", material or {})
    if environment is not None:
        of = {"sky": True} if environment == "sky" else {"file": os.path.abspath(os.fspath(environment))}
        text += table("environment", of)
    return text


def table_of_light(light: Mapping[str, object]) -> str:
    """A light as a table of a scene file."""
    if not isinstance(light, Mapping):
        raise ValueError(f"lights: {light!r}; give tables such as {{'kind': 'headlight', 'towards': [-1, 1, 1]}}")
    return "[[light]]\n" + "".join(f"{key} = {toml(key, value)}\n" for key, value in light.items())
