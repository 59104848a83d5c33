"""The plugin of pytest: the fixtures `assert_right` and `golden`, and the option `--bless`."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any, Callable, Mapping, Optional

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("splatref")
    group.addoption(
        "--bless",
        action="store_true",
        help="overwrite goldens that differ or are missing; their tests still fail",
    )
    group.addoption(
        "--splatref-reports",
        metavar="DIR",
        help="write the pages of wrong verdicts here [default: the tmp_path of each test]",
    )


def _place(request: pytest.FixtureRequest) -> Path:
    """The folder of a test's pages."""
    chosen: Optional[str] = request.config.getoption("--splatref-reports")
    if chosen is None:
        place: Path = request.getfixturevalue("tmp_path")
        return place
    return Path(chosen)


@pytest.fixture
def assert_right(request: pytest.FixtureRequest) -> Callable[..., Any]:
    """`assert_right(scene, camera, planes, ...)`, as `splatref.testing.assert_right`.

    A failure leaves its page in the `tmp_path` of the test, or in `--splatref-reports`.
    """
    from . import testing

    count = 0

    def check(scene: Any, camera: Any, planes: Mapping[str, object], **more: Any) -> Any:
        __tracebackhide__ = True
        nonlocal count
        count += 1
        name = re.sub(r"[^\w.-]+", "-", request.node.name).strip("-")
        end = "" if count == 1 else f"-{count}"
        more.setdefault("report", _place(request) / f"{name}{end}.html")
        try:
            return testing.assert_right(scene, camera, planes, **more)
        except AssertionError as error:
            lines = str(error)
        # Outside of the handler, so that the report has the lines alone.
        pytest.fail(lines, pytrace=False)

    return check


class Golden:
    """Compares pictures with stored ones, bit for bit, in a folder `goldens` beside the test file."""

    def __init__(self, folder: Path, bless: bool) -> None:
        self.folder = folder
        self._bless = bless

    def __call__(self, name: str, picture: Any, **tolerance: Any) -> None:
        """Fails unless the picture equals `goldens/NAME.exr`; the arguments of `compare` allow more.

        With `--bless` the golden is written, and the test still fails, so that nobody blesses unseen.
        """
        __tracebackhide__ = True
        from . import _picture, compare

        if not re.fullmatch(r"[\w.-]+", name):
            raise ValueError(f"golden {name!r}; give a name of letters, digits, _, - and .")
        path = self.folder / f"{name}.exr"
        if path.exists():
            found = compare(path, picture, **tolerance)
            if found.passed:
                return
            why = str(found)
        else:
            why = "there is no golden yet; --bless writes it"
        if not self._bless:
            pytest.fail(f"golden {name}: {why}\nThe golden is {path}", pytrace=False)
        os.makedirs(self.folder, exist_ok=True)
        if isinstance(picture, _picture.Picture):
            picture.save(path, compression="zip")
        else:
            _picture.save_planes(path, picture)
        pytest.fail(f"golden {name}: {why}\nblessed: wrote {path}", pytrace=False)


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Golden:
    """`golden(name, picture)`: the picture equals `goldens/NAME.exr` beside the test file, bit for bit."""
    return Golden(request.path.parent / "goldens", bool(request.config.getoption("--bless")))
