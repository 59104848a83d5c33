"""Assertions for the test suites of renderers. `pytest` finds the fixtures by itself."""

from __future__ import annotations

import os
from typing import Any, Mapping, Optional

from ._scene import AnyCamera, Path, Scene
from ._verdict import Verdict, verify

__all__ = ["assert_right"]


def assert_right(
    scene: Scene,
    camera: Optional[AnyCamera],
    planes: Mapping[str, object],
    *,
    report: Optional[Path] = None,
    allow: tuple[str, ...] = (),
    **more: Any,
) -> Verdict:
    """Fails with the lines of the verdict unless a right renderer may have left these planes.

    report: where the page of a failure is written; nowhere if absent.
    allow: outcomes beside "right" that pass: "unlike", "undecidable".
    more: as for `verify`.
    """
    __tracebackhide__ = True
    for outcome in allow:
        if outcome not in ("unlike", "undecidable"):
            raise ValueError(f"allow: {outcome!r}; give unlike or undecidable")
    verdict = verify(scene, camera, planes, **more)
    if verdict.right or verdict.outcome in allow:
        return verdict
    lines = str(verdict)
    if report is not None:
        report = os.path.abspath(os.fspath(report))
        os.makedirs(os.path.dirname(report), exist_ok=True)
        verdict.report(report)
        lines += f"\nreport         {report}"
    raise AssertionError(lines)

