"""How long calls run: threads, tiles and the progress bar."""

from __future__ import annotations

import importlib
import importlib.util
import sys
import time
from dataclasses import dataclass
from typing import Any, Callable, Optional

# Work that is done sooner shows no bar.
_PATIENCE = 1.0


@dataclass
class How:
    """What the Rust side reads of a call."""

    threads: int
    tile: int
    progress: Optional[Callable[[str, int, int], None]]


_threads, _tile = 0, 32


def use(*, threads: Optional[int] = None, tile: Optional[int] = None) -> None:
    """Chooses how pictures are computed; no choice changes a bit of them.

    threads: at most so many threads; 0 (the default) is one for each core.
    tile: the side of a tile in pixels: 8, 16, 32 (the default) or 64.

    Raises `ValueError` if there are no such tiles or too many threads.
    """
    global _threads, _tile
    if threads is not None:
        if not 0 <= threads <= 1024:
            raise ValueError(f"threads={threads}; give 0 to 1024")
        _threads = int(threads)
    if tile is not None:
        if tile not in (8, 16, 32, 64):
            raise ValueError(f"tile={tile}; give 8, 16, 32 or 64")
        _tile = int(tile)


def _in_notebook() -> bool:
    return "ipykernel" in sys.modules


class _Bar:
    """A bar of tqdm that appears once the work has taken a second."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._bar: Any = None

    def __call__(self, step: str, done: int, of: int) -> None:
        if time.monotonic() - self._start < _PATIENCE:
            return
        if self._bar is None:
            self._bar = importlib.import_module("tqdm.auto").tqdm(leave=False)
        self._bar.set_description_str(step, refresh=False)
        self._bar.total = of if of > 1 else None
        self._bar.n = done
        self._bar.refresh()

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


class calling:
    """Runs a call with a progress bar: `with calling(progress) as how: ...`."""

    def __init__(self, progress: Optional[bool] = None) -> None:
        if progress is None:
            progress = _in_notebook() or sys.stderr is not None and sys.stderr.isatty()
        self._bar: Optional[_Bar] = None
        if progress:
            if importlib.util.find_spec("tqdm") is not None:
                self._bar = _Bar()

    def __enter__(self) -> How:
        return How(_threads, _tile, self._bar)

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()
