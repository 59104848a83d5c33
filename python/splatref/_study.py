"""Studies: the error and the time of every candidate of a scene."""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass
from typing import Any, Optional, Union

from . import _splatref
from ._call import calling
from ._scene import AnyCamera, Path, Scene, choice_of
from ._text import choices

StudySource = Union[Scene, Path]


@dataclass(frozen=True)
class Candidate:
    """A method with its settings, measured.

    options: what turns the scene into this candidate, as the command line writes it: "--method ewa --cutoff 1".
    method: the name of the method.  surfels: how many surfels its scene has.
    errors: by the names of the metrics, such as "rmse"; an undefined error is absent.
    times: milliseconds of each timed picture. Empty for emulated buffer formats, whose times mean nothing.
    machine: the processor and the number of threads that took the times.
    """

    options: str
    method: str
    surfels: int
    errors: dict[str, float]
    times: tuple[float, ...]
    machine: str

    @property
    def time(self) -> Optional[float]:
        """The median time of a picture in milliseconds; of two middle ones, the later. `None` without times."""
        return sorted(self.times)[len(self.times) // 2] if self.times else None


@dataclass(frozen=True)
class Study:
    """What a study measured.

    candidates: in the order in which `splatref study` tries them.
    left_out: each method that cannot draw the scene, and why.
    truth: how the true picture was computed, in words.
    """

    candidates: list[Candidate]
    left_out: list[tuple[str, str]]
    truth: str

    def front(self, metric: str = "rmse") -> list[Candidate]:
        """The candidates that no other candidate beats in both time and this error, the fastest first.

        Raises `ValueError` for an unknown metric, and if machines of several kinds took the times, because
        these times cannot be compared.
        """
        machines = sorted({one.machine for one in self.candidates if one.times})
        if len(machines) > 1:
            raise ValueError(f"times of several machines cannot be compared: {'; '.join(machines)}")
        nan = float("nan")
        points = [(nan if one.time is None else one.time, one.errors.get(metric, nan)) for one in self.candidates]
        return [self.candidates[i] for i in _splatref.front(metric, points)]


def study(
    scene: StudySource,
    camera: Optional[AnyCamera] = None,
    *,
    method: Optional[str] = None,
    truth: Optional[StudySource] = None,
    frame: Optional[int] = None,
    progress: Optional[bool] = None,
    **settings: object,
) -> Study:
    """Measures every method that can draw a scene, with one setting after the other at other values.

    The candidates and errors are those of the command `splatref study`. It times the candidates by turns too.

    scene: the name of a file or shape, or a scene that was opened from one. Both are loaded anew, because
        candidates differ in what they load; a name saves the memory of the scene that you hold.
    method: study this method alone. The settings that you give hold for every candidate that has them.
    truth: use the surface of this scene as the truth, such as the mesh that the points were sampled from.

    The other arguments are those of `render`. Raises `ValueError` if no method can draw the scene, and for a
    scene that came from arrays.
    """
    chosen = choices("study", method, settings, frame)
    with calling(progress) as how:
        loaded = load_candidates(how, scene, camera, chosen, truth)
        found = loaded.run(how, list(range(len(loaded.candidates))))
    return from_parts(loaded.candidates, loaded.left_out, [found])


def load_candidates(
    how: Any, scene: StudySource, camera: Optional[AnyCamera], chosen: Any, truth: Optional[StudySource] = None
) -> Any:
    """The loaded candidates, as Rust has them."""
    other = None if truth is None else _source("truth", truth)
    loaded = _splatref.Study(how, _source("scene", scene), choice_of(camera), chosen, other)
    for what in loaded.warnings:
        warnings.warn(what, stacklevel=3)
    return loaded


def _source(name: str, source: object) -> Any:
    if isinstance(source, Scene):
        return source._rust
    if isinstance(source, (str, os.PathLike)):
        return os.fspath(source)
    raise TypeError(f"{name}: {type(source).__name__}; give a name or a splatref.Scene")


def from_parts(candidates: list[tuple[str, str]], left_out: list[tuple[str, str]], parts: list[Any]) -> Study:
    """A study of what Rust measured, in parts that have the candidates in their order."""
    found = []
    for _, _, machine, rows in parts:
        found += [(surfels, dict(errors), tuple(times), machine) for surfels, errors, times in rows]
    measured = [Candidate(options, method, *rest) for (options, method), rest in zip(candidates, found)]
    return Study(measured, list(left_out), parts[0][1])


__all__ = ["Candidate", "Study", "study"]
