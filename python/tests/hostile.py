"""Random calls with hostile arguments: an exception or an answer, never a crash, and no leak.

    python tests/hostile.py --calls 10000 --seed 1

A seed gives the same calls again. A call may raise ValueError, TypeError, OSError, MemoryError or
OverflowError. The script prints how many calls did, and how much memory the process holds at
quarters of the calls; it fails if the last quarter grew by more than 24 MiB.
"""

from __future__ import annotations

import argparse
import collections
import random
import sys
import warnings
from typing import Any, Callable

import numpy as np

import splatref as sr

EXPECTED = (ValueError, TypeError, OSError, MemoryError, OverflowError, KeyError)
DTYPES = ["f4", "f8", "f2", ">f4", ">f8", "i4", "i8", "u1", "u4", "u8", "i2", "?", "c8", "O", "S3", "U2", "M8[s]", "g"]


def held() -> int:
    """MiB that the process holds; 0 where the system does not tell."""
    try:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * 4096 >> 20
    except OSError:
        return 0


class Maker:
    """Makes arguments."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.numpy = np.random.default_rng(seed)

    def number(self) -> Any:
        some = [0, -1, 1, 2, 3, 7, 0.5, 1e-45, 1e30, -0.0, float("nan"), float("inf"), 2**31, 2**32, 2**63, 2**70]
        return self.random.choice([*some, None, "x", True, np.float32(1), np.int8(3), b"", [], {}])

    def array(self, *shapes: tuple[int, ...]) -> Any:
        shape = list(self.random.choice(shapes))
        if self.random.random() < 0.15:
            shape = [self.random.choice([0, 1, 2, 3, 5]) for _ in range(self.random.randrange(5))]
        if self.random.random() < 0.02:
            return self.number()
        values = self.numpy.choice(np.array([0, 1, 0.5, -1, 2, 0.25, 1e30, np.nan, np.inf]), shape, p=[0.2, 0.2, 0.2, 0.1, 0.1, 0.14, 0.02, 0.02, 0.02])
        dtype = "f4" if self.random.random() < 0.6 else self.random.choice(DTYPES)
        try:
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                array = values.astype(dtype)
        except (ValueError, TypeError, OverflowError):
            array = values
        return self.layout(array)

    def layout(self, array: Any) -> Any:
        kind = self.random.randrange(14)
        if kind == 0 and array.ndim:
            return array[::-1]
        if kind == 1 and array.ndim:
            return np.repeat(array, 2, axis=0)[::2]
        if kind == 2:
            return np.asfortranarray(array)
        if kind == 3 and array.ndim:
            return np.broadcast_to(array[:1], (self.random.choice([3, 40, 2**31, 2**32, 2**40]), *array.shape[1:]))
        if kind == 4:
            array.flags.writeable = False
        if kind == 5:
            return np.ma.masked_invalid(array) if array.dtype.kind == "f" else array
        if kind == 6:
            return array.tolist()
        if kind == 7 and array.ndim and array.dtype.kind not in "O":
            raw = np.frombuffer(b"x" + array.tobytes(), np.uint8)[1:]
            return raw.view(array.dtype).reshape(array.shape) if raw.size else array
        return array


def calls(make: Maker, scene: sr.Scene, picture: sr.Picture) -> list[Callable[[], Any]]:
    """The kinds of calls."""
    pick, number, array = make.random.choice, make.number, make.array
    n = pick([1, 2, 5, 40])
    camera = sr.Camera(size=(24, 16))
    size = picture["Z"].shape
    rows = [setting.name for setting in sr.methods.settings()]

    def some(**values: Callable[[], Any]) -> dict[str, Any]:
        return {name: value() for name, value in values.items() if make.random.random() < 0.5}

    def new_scene() -> sr.Scene:
        more = some(
            normals=lambda: array((n, 3)),
            radii=lambda: pick([1, array((n,)), number()]),
            colors=lambda: array((n, 3)),
            opacities=lambda: pick([array((n,)), number()]),
            tangents=lambda: array((n, 2, 3)),
        )
        return sr.Scene(array((n, 3)), **more)

    def planes() -> dict[str, Any]:
        names = [*picture, "rgb", "x", "visibility", "margin.X", ""]
        found: dict[str, Any] = {}
        for name in make.random.sample(names, make.random.randrange(4)):
            value = picture[name] if name in picture and make.random.random() < 0.6 else array(size, (*size, 3), (3, *size))
            if make.random.random() < 0.2:
                value = {"data": value, pick(["empty", "format", "meaning", "id_base", "range"]): number()}
            found[name] = value
        return found

    def records() -> Any:
        whole = sr.project(scene, camera)
        columns: dict[Any, Any] = {name: whole[name] for name in whole.dtype.names}
        for name in make.random.sample([*columns, "x", ""], make.random.randrange(3)):
            count = len(whole)
            columns[name] = pick([number(), array((count,), (count, 2), (count, 3), (count, 4))])
        odd = [whole[::-1], whole[:0], whole[::2], whole["center"], whole.view(np.uint8), number()]
        return pick([columns, columns, whole, *odd])

    def new_camera() -> sr.Camera:
        return sr.Camera(
            **some(
                size=lambda: pick([(24, 16), number(), (number(), 3)]),
                K=lambda: pick([np.diag([20, 20, 1.0]), array((3, 3))]),
                world_to_camera=lambda: pick([np.eye(4), array((4, 4), (3, 4))]),
                convention=lambda: pick(["opencv", "opengl", "x", number()]),
                eye=lambda: pick([(0, 0, 4), array((3,)), number()]),
                fov=lambda: pick([40, number()]),
                near=lambda: pick([0.1, number()]),
            )
        )

    def small(camera: sr.Camera) -> sr.Picture:
        width, height = scene.camera(camera).size
        return sr.render(scene, camera) if width * height < 1 << 14 else sr.render(scene)

    return [
        new_scene,
        lambda: sr.render(new_scene(), camera, method=pick([None, "ewa", "pyramid", "blue", "peeling", "x"])),
        lambda: small(new_camera()),
        lambda: sr.render(scene, camera, **{pick(rows): number() for _ in range(2)}),
        lambda: sr.verify(scene, camera, planes(), cause=make.random.random() < 0.1, **some(promise=lambda: pick(["gpu", "ieee", number()]))),
        lambda: sr.verify(scene, camera, planes(), **some(depth=lambda: {"meaning": pick(["1/t", "z-buffer", number()]), "near": number()})),
        lambda: sr.verify(scene, camera, planes(), cause=False, records=records()),
        lambda: sr.compare(planes(), planes(), **some(max_ulp=number, max_abs=number, planes=lambda: [pick(["Z", "*", ""])])),
        lambda: sr.surfels.greedy(array((n, 3), (60, 3)), **some(count=number, start=number, seed=number)),
        lambda: sr.surfels.progressive(array((n, 3), (60, 3)), **some(count=number, start=number, seed=number)),
        lambda: sr.surfels.quality(array((n, 3)), array((2,), (n,))),
        lambda: sr.metrics.flip(array((12, 12, 3), (*size, 3)), array((12, 12, 3))),
        lambda: sr.metrics.ssim(array((12, 12, 3), (*size, 3)), array((12, 12, 3))),
        lambda: sr.explain(scene, camera, (number(), number())),
        lambda: sr.sha256({"a": planes()}),
        lambda: sr.render(scene, [camera, pick([camera, None, number()])]),
        lambda: sr.laws.epsilon(lambda t, nearest, band: pick([True, number()]), kinds=["algebraic"]),
    ]


def run(count: int, seed: int) -> collections.Counter[str]:
    """Makes the calls; an exception that is not expected is raised."""
    make = Maker(seed)
    scene = sr.Scene.open("sphere", count=60)
    picture = sr.render(scene, sr.Camera(size=(24, 16)), stages=True)
    ends: collections.Counter[str] = collections.Counter()
    memory = []
    for i in range(count):
        if i % max(1, count // 4) == 0:
            memory.append(held())
        call = make.random.choice(calls(make, scene, picture))
        try:
            call()
            ends["answered"] += 1
        except EXPECTED as error:
            ends[type(error).__name__] += 1
            if not str(error):
                raise
    memory.append(held())
    print("MiB at each quarter:", *memory)
    if count >= 4000 and memory[-1] - memory[-2] > 24:
        raise AssertionError("the process holds more and more memory")
    return ends


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--calls", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    print(dict(run(given.calls, given.seed)))
    sys.exit(0)
