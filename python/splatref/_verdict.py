"""Verdicts on the planes of another renderer."""

from __future__ import annotations

import html
import json
import os
from dataclasses import dataclass, field
from typing import Any, Iterator, Mapping, Optional, Union

import numpy as np

from . import _splatref
from ._arrays import Array, stored_plane
from ._call import calling
from ._picture import Picture, _rust, pixel_of
from ._records import packed_records
from ._scene import AnyCamera, Path, ResolvedCamera, Scene, choice_of
from ._text import choices, table, toml

DOUBTS: dict[str, int] = dict(_splatref.Judged.doubts())


@dataclass(frozen=True)
class Worst:
    """The worst wrong pixel of a stage.

    stage: its name.  pixel: (column, row).  fault: what is wrong, in words.
    error: in bounds; above 1, or inf where there is no bound.
    """

    stage: str
    pixel: tuple[int, int]
    error: float
    fault: str

    def __str__(self) -> str:
        return f"{self.stage} at {self.pixel}: {self.fault}"


@dataclass(frozen=True)
class Stage:
    """The findings about a stage of the method.

    planes: the planes that were judged; empty if none of this stage was given.
    missing: planes that would let the verdict judge more.
    unjudged: planes that were given but not judged, because planes that they follow from are missing.
    wrong: the number of wrong pixels.
    error: float32 (height, width), the error in bounds; a pixel is right up to 1.
    doubts: uint8 (height, width), the undecided decisions as bits of `DOUBTS`.
    worst: the worst wrong pixel, if any.
    causes: what the wrong pixels have in common: how many lack a surfel, and so on.
    """

    name: str
    planes: tuple[str, ...]
    missing: tuple[str, ...]
    unjudged: tuple[str, ...]
    wrong: int
    error: Array = field(repr=False)
    doubts: Array = field(repr=False)
    worst: Optional[Worst]
    causes: dict[str, int]


class _ByPlane(Mapping[str, Array]):
    """The errors of stages, found by the name of a stage or of a plane."""

    def __init__(self, stages: tuple[Stage, ...]) -> None:
        self._stages = stages

    def __getitem__(self, name: str) -> Array:
        for stage in self._stages:
            if name == stage.name or {name, f"{name}.RGB", name.upper()} & set(stage.planes):
                return stage.error
        raise KeyError(f"no stage and no judged plane is called {name!r}; there are {', '.join(self)}")

    def __iter__(self) -> Iterator[str]:
        for stage in self._stages:
            yield stage.name
            yield from stage.planes

    def __len__(self) -> int:
        return sum(1 for _ in self)


class Verdict:
    """Whether a right renderer may have left some planes.

    outcome: "right", "wrong", "undecidable", or "unlike": right in each pixel, but unlike any right
        renderer that was tried.
    right: whether the outcome is "right".
    stages: the findings of each stage, in order.
    worst: the worst pixel of the first wrong stage, if any.
    causes: known mistakes that explain the wrong pixels, in words, the likeliest first.
    error: the errors in bounds by the name of a stage or of a plane, float32 (height, width). A stage
        is judged as a whole: a plane has the error of its stage.
    undecided: bool (height, width): where a decision may be taken either way.
    """

    def __init__(self, judged: Any) -> None:
        self._judged = judged
        self.outcome: str = judged.outcome
        self.right: bool = judged.outcome == "right"
        self.stages: tuple[Stage, ...] = tuple(_stage(one) for one in judged.stages())
        self.causes: list[str] = [] if judged.likely is None else [judged.likely]
        self.error: Mapping[str, Array] = _ByPlane(self.stages)

    @property
    def worst(self) -> Optional[Worst]:
        """The worst pixel of the first wrong stage."""
        wrong = (stage for stage in self.stages if stage.wrong)
        return next((stage.worst for stage in wrong), None)

    @property
    def undecided(self) -> Array:
        """Where a decision may be taken either way, as bool (height, width)."""
        decisions = ~np.uint8(DOUBTS["without bounds"])
        masks = [(stage.doubts & decisions) != 0 for stage in self.stages]
        found: Array = np.logical_or.reduce(masks)
        return found

    @property
    def camera(self) -> ResolvedCamera:
        """The camera of the reference."""
        return ResolvedCamera._of(self._judged.camera)

    @property
    def json(self) -> dict[str, Any]:
        """The verdict as `splatref verify --json` writes it."""
        found: dict[str, Any] = json.loads(self._judged.json)
        return found

    def stage(self, name: str) -> Stage:
        """The findings of the stage with this name."""
        for stage in self.stages:
            if stage.name == name:
                return stage
        raise KeyError(f"no stage is called {name!r}; there are {', '.join(s.name for s in self.stages)}")

    def explain(self, x: int, y: int) -> str:
        """Every decision at the pixel in column x and row y, in words."""
        with calling(False) as how:
            return str(self._judged.explain(how, pixel_of((x, y))))

    def report(self, path: Path, *, progress: Optional[bool] = None) -> None:
        """Writes a page that shows each stage, its errors and the worst pixels in a browser.

        The file is complete or absent. Raises `OSError` if it cannot be written.
        """
        with calling(progress) as how:
            self._judged.report(how, os.fspath(path))

    def __str__(self) -> str:
        return "\n".join(self._judged.lines)

    def __repr__(self) -> str:
        return f"<Verdict: {self._judged.lines[-1]}>"

    def _repr_html_(self) -> str:
        def row(stage: Stage) -> str:
            if not stage.planes:
                word, colour = "not judged", "inherit"
            elif stage.wrong:
                word, colour = f"{stage.wrong} pixels wrong", "#c00"
            else:
                word, colour = "right", "#080"
            cells = [html.escape(stage.name), f'<b style="color:{colour}">{word}</b>']
            cells += [html.escape(", ".join(stage.planes)), html.escape(str(stage.worst or ""))]
            return "<tr>" + "".join(f'<td style="text-align:left">{cell}</td>' for cell in cells) + "</tr>"

        head = "".join(f"<th>{name}</th>" for name in ("stage", "", "planes", "worst"))
        rows = "".join(map(row, self.stages))
        causes = "".join(f"<p>looks like: {html.escape(cause)}</p>" for cause in self.causes)
        ending = html.escape(self._judged.lines[-1])
        return f"<p><b>{ending}</b></p><table><tr>{head}</tr>{rows}</table>{causes}"


def _stage(found: Mapping[str, Any]) -> Stage:
    worst = found.get("worst")
    return Stage(
        found["name"],
        tuple(found["planes"]),
        tuple(found["missing"]),
        tuple(found["unjudged"]),
        found["wrong"],
        found["errors"],
        found["doubts"],
        None if worst is None else Worst(found["name"], *worst),
        dict(found["causes"]),
    )


@dataclass
class _Asked:
    """What the Rust side reads of a call."""

    text: str
    records: Optional[bytes]
    lenient: bool
    promise: Optional[str]
    budget: float
    cause: bool


PlaneOfClient = Union[object, Mapping[str, object]]


def verify(
    scene: Scene,
    camera: Optional[AnyCamera],
    planes: Mapping[str, PlaneOfClient],
    *,
    method: Optional[str] = None,
    frame: Optional[int] = None,
    promise: Optional[str] = None,
    ties: Optional[str] = None,
    accumulator: Optional[str] = None,
    origin: Optional[str] = None,
    depth: Optional[Mapping[str, object]] = None,
    records: Optional[object] = None,
    budget: float = 0.02,
    cause: bool = True,
    progress: Optional[bool] = None,
    **settings: object,
) -> Verdict:
    """Judges the planes of a renderer, stage by stage, without a tolerance.

    planes: arrays (height, width) or (height, width, 3) by the names of the method's planes, such as
        {"visibility.Z": z, "visibility.id": ids, "rgb": rgb}; `methods.planes(method)` lists them, and "rgb" is the
        picture. float16 counts as stored in 16 bits. A plane may be a table: {"data": array} and
        keys of the TOML of `splatref verify`, such as "format", "empty", "id_base", "encoding",
        "premultiplied", "range", "meaning", "near" and "far".
    promise: how precise the renderer's operations are: "gpu" (the default), "precise" or "ieee".
    ties: which of several equally near fragments wins: "lowest" (the default), "last" or "any".
    accumulator: how sums are stored between two additions: "f32" (the default) or "f16".
    origin: "top-left" (the default), or "bottom-left" where rows run up.
    depth: what all depths mean: {"meaning": "reversed-z", "near": 0.1, "far": inf}.
    records: your projected splats, one for each that you draw, in any order: a structured array as `project`
        returns it, or a dictionary of arrays by the names of its fields. Then the projection is judged by its
        fields, and the rest from your records.
    budget: "undecidable" if more than this fraction of the pixels has undecided sums, 0 to 1.
    cause: whether to look for the mistake behind wrong planes, which takes about as long as the verdict.
    settings: as for `render`; number="f64" if the renderer computed in f64 and stored float32.

    Raises `ValueError` for planes that cannot be judged: the text names the plane and the cure.
    """
    if not isinstance(planes, Mapping):
        raise TypeError(f"planes: {type(planes).__name__}; give a dictionary of arrays by name")
    chosen = choices("verify", method, settings, frame)
    tables, arrays = "", []
    for given, value in planes.items():
        name = "RGB" if given == "rgb" else str(given)
        keys: Mapping[str, object] = {}
        if isinstance(value, Mapping):
            keys = {key: one for key, one in value.items() if key != "data"}
            if "data" not in value:
                raise ValueError(f"planes: {given!r} is a table without \"data\"; give the array as \"data\"")
            value = value["data"]
        numbers, format = stored_plane(f"planes[{given!r}]", value)
        arrays.append((name, numbers, format))
        if keys:
            tables += f"[planes.{toml('planes', name)}]\n"
            tables += "".join(f"{key} = {toml(key, one)}\n" for key, one in keys.items())
    of_all = {"accumulator": accumulator, "ties": ties, "origin": origin}
    text = "".join(f"{key} = {toml(key, one)}\n" for key, one in of_all.items() if one is not None)
    text += table("depth", depth or {}) + tables
    own = None if records is None else packed_records(records, scene, chosen)
    asked = _Asked(text, own, isinstance(planes, Picture), promise, float(budget), bool(cause))
    with calling(progress) as how:
        return Verdict(_splatref.verify(how, _rust(scene), choice_of(camera), chosen, arrays, asked))
