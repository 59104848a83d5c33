"""The laws of compositing, tried on a function of yours: a counterexample, or `None` if it keeps them.

A law calls your function at thousands of inputs and shrinks what breaks it to the simplest inputs.
The inputs depend only on the version of splatref. Numbers are scalars and arrays of `numpy.float32`,
so that your function computes in float32; `number="f64"` gives float64.

kinds: which laws to try: "algebraic" (a renderer that breaks one is wrong), "exact" (right to the
    bit), and "odd inputs" (infinities, -0, tiny and huge numbers); all three if absent.

An exception of your function ends the search and is raised.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Optional, Sequence

from . import _splatref

__all__ = ["Counterexample", "bins", "epsilon", "groups", "means", "over", "sums", "under"]

KINDS = ("algebraic", "exact", "odd inputs")


@dataclass(frozen=True)
class Counterexample:
    """Inputs at which a function breaks a law.

    law: the law, in words.  kind: see above.  picture: what in a picture stands on the law.
    inputs, expected, found: as text.
    """

    law: str
    kind: str
    picture: str
    inputs: str
    expected: str
    found: str
    text: str

    def __str__(self) -> str:
        return self.text


def _law(
    name: str, functions: list[Callable[..., Any]], kinds: Optional[Sequence[str]], number: str
) -> Optional[Counterexample]:
    for function in functions:
        if not callable(function):
            raise TypeError(f"laws.{name}: {function!r} is no function")
    found = _splatref.law(name, functions, list(KINDS if kinds is None else kinds), number)
    return None if found is None else Counterexample(**found)


def over(
    over: Callable[..., Any], *, kinds: Optional[Sequence[str]] = None, number: str = "f32"
) -> Optional[Counterexample]:
    """Blending from back to front: `over(below_color, below_alpha, alpha, color)`.

    Returns the colour, over black, and the opacity after the nearer layer is laid over those below.
    """
    return _law("over", [over], kinds, number)


def under(
    under: Callable[..., Any], *, kinds: Optional[Sequence[str]] = None, number: str = "f32"
) -> Optional[Counterexample]:
    """Blending from front to back: `under(color, alpha, through, layer_alpha, layer_color)`.

    Returns the colour, the opacity, and how much light is let through, after the farther layer.
    """
    return _law("under", [under], kinds, number)


def epsilon(
    visible: Callable[..., Any], *, kinds: Optional[Sequence[str]] = None, number: str = "f32"
) -> Optional[Counterexample]:
    """The test of a visibility pass: `visible(depth, nearest, epsilon)` returns whether it passes."""
    return _law("epsilon", [visible], kinds, number)


def sums(
    add: Callable[..., Any],
    average: Callable[..., Any],
    *,
    kinds: Optional[Sequence[str]] = None,
    number: str = "f32",
) -> Optional[Counterexample]:
    """Weighted sums: `add(sum, weight, color)` and `average(sum, total_weight)` return a colour."""
    return _law("sums", [add, average], kinds, number)


def means(
    mean: Callable[..., Any], *, kinds: Optional[Sequence[str]] = None, number: str = "f32"
) -> Optional[Counterexample]:
    """The mean of up to four neighbours in a pyramid: `mean(takes, weights, values)`, each of four."""
    return _law("means", [mean], kinds, number)


def bins(
    bin: Callable[..., Any],
    voronoi: Callable[..., Any],
    *,
    kinds: Optional[Sequence[str]] = None,
    number: str = "f32",
) -> Optional[Counterexample]:
    """Low-precision depth: `bin(range, depth)` and `voronoi(range, depth, ratio)`, in units of a bin.

    range is (nearest, farthest, count).
    """
    return _law("bins", [bin, voronoi], kinds, number)


def groups(
    compose: Callable[..., Any], *, kinds: Optional[Sequence[str]] = None, number: str = "f32"
) -> Optional[Counterexample]:
    """The operator over the depth-images of groups: `compose(samples, epsilon)`.

    A sample is a row of nine numbers: depth (inf where an image is empty), weight, then normal (3),
    colour (3) and opacity times the weight. Returns such a row of sums, and how many samples passed.
    """
    return _law("groups", [compose], kinds, number)
