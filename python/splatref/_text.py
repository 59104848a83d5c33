"""Writes Python values as the command line and scene files have them, so that one parser reads them all."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Mapping, Optional

import numpy as np

from . import _splatref
from ._arrays import as_array

# The most numbers of a setting or a key; arrays may claim billions.
_MOST = 4096

ROWS: list[dict[str, Any]] = _splatref.rows()
_BY_NAME = {row["name"]: row for row in ROWS}


def _number(value: object) -> Optional[str]:
    """A number as text that gives the same number again; `None` if it is none."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, (bool, np.bool_)):
        return None
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return None


def _short(value: object) -> str:
    """A value in an error."""
    text = repr(value)
    return text if len(text) <= 200 else f"{text[:200]} ..."


def setting(name: str, value: object) -> str:
    """A value of a setting as the command line has it."""
    number = _number(value)
    if number is not None:
        return number
    if value is None:
        return "none"
    if isinstance(value, (bool, np.bool_)):
        return "on" if value else "off"
    if isinstance(value, str):
        return value
    if isinstance(value, Mapping):
        parts = str(_BY_NAME[name]["form"]).split("|")[0].lower().split(",")
        if sorted(value) != sorted(parts):
            raise ValueError(f"{name}={value!r}; give {', '.join(parts)}")
        return ",".join(setting(name, value[part]) for part in parts)
    if isinstance(value, (list, tuple, np.ndarray)) and np.size(value) <= _MOST:
        numbers = [_number(one) for one in value]
        if all(one is not None for one in numbers):
            return ",".join(one for one in numbers if one is not None)
    raise ValueError(f"{name}={_short(value)}; give {_BY_NAME[name]['form']}")


@dataclass
class Choices:
    """What the Rust side reads of the choices of a call."""

    method: Optional[str]
    settings: list[tuple[str, str]]
    frame: Optional[int]


def choices(function: str, method: Optional[str], settings: Mapping[str, object], frame: Optional[int] = None) -> Choices:
    """The choices of a call; a setting that is not there is a `TypeError`, as for any function."""
    for name in settings:
        if name not in _BY_NAME:
            raise TypeError(
                f"{function}() has no setting {name!r}; it takes {', '.join(sorted(_BY_NAME))}"
            )
    # A preset comes before its parts, whatever the order of the keywords: rows have this order.
    given = [row["name"] for row in ROWS if row["name"] in settings]
    return Choices(method, [(name, setting(name, settings[name])) for name in dict.fromkeys(given)], frame)


def toml(name: str, value: object) -> str:
    """A value as TOML."""
    number = _number(value)
    if number is not None:
        return number
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (str, os.PathLike)):
        text = json.dumps(os.fspath(value), ensure_ascii=False)
        return text.replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        parts = (f"{json.dumps(str(key))} = {toml(name, one)}" for key, one in value.items())
        return "{ " + ", ".join(parts) + " }"
    if hasattr(value, "__array__"):
        array = as_array(name, value)
        if array.size > _MOST:
            raise ValueError(f"{name}: an array with the shape {array.shape}; give a few numbers")
        value = array.tolist()
    if isinstance(value, (list, tuple)) and len(value) <= _MOST:
        return "[" + ", ".join(toml(name, one) for one in value) + "]"
    raise ValueError(f"{name}={_short(value)}; give numbers, text, or a list or table of them")


def table(header: str, values: Mapping[str, object]) -> str:
    """A table of a scene file; values that are `None` are left out."""
    lines = [f"{key} = {toml(key, value)}\n" for key, value in values.items() if value is not None]
    return f"[{header}]\n" + "".join(lines) if lines else ""
