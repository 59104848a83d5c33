"""Some of the random calls of `hostile.py`; that script makes ten thousand."""

from __future__ import annotations

import os

import hostile


def test_hostile_calls_are_answered_or_refused() -> None:
    ends = hostile.run(int(os.environ.get("SPLATREF_HOSTILE", "400")), seed=20261127)
    assert ends["answered"] > 20 and ends["ValueError"] > 100, ends
