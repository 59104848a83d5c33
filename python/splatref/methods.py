"""What there is to choose: methods, their settings, and the planes that they leave."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

from . import _splatref
from ._text import ROWS

__all__ = ["PlaneRow", "Setting", "names", "planes", "settings"]


def names() -> dict[str, str]:
    """Each method, and what it does."""
    return dict(_splatref.methods())


@dataclass(frozen=True)
class Setting:
    """A setting: a keyword of `render`, `verify` and `explain`.

    name: the keyword.  help: what it does.  unit, range: of its values; empty if there is none.
    form: how the command line writes a value.  defaults: by method; "" for settings of all pictures.
    """

    name: str
    help: str
    unit: str
    range: str
    form: str
    defaults: dict[str, Optional[str]]


def settings(method: Optional[str] = None) -> list[Setting]:
    """The settings of a method, its groups and the picture; of all methods without a name.

    Raises `ValueError` if there is no such method.
    """
    if method is not None and method not in names():
        raise ValueError(f"no method is called {method!r}; give one of {', '.join(names())}")
    rows = (row for row in ROWS if method is None or "" in row["defaults"] or method in row["defaults"])
    keys = ("name", "help", "unit", "range", "form", "defaults")
    return [Setting(*(row[key] for key in keys)) for row in rows]


@dataclass(frozen=True)
class PlaneRow:
    """A plane of a method: its stage, its name, its unit, and what a value means."""

    stage: str
    name: str
    unit: str
    meaning: str


def planes(method: str = "ewa") -> list[PlaneRow]:
    """The planes that the stages of a method leave, which `verify` takes."""
    return [PlaneRow(*row) for row in _splatref.planes(method)]
