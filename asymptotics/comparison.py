"""What a comparison of numerics with a series found: the order of their difference, of each part, and the verdict."""

from dataclasses import dataclass

import numpy as np

from .explain import Explanation

TOLERANCE = 0.05
PART_NAMES = {"real": "real part", "imag": "imaginary part"}


class OrderMismatch(AssertionError):
    """The difference falls at another order than expected; `comparison` holds the numbers."""

    def __init__(self, comparison: "Comparison") -> None:
        super().__init__(f"{comparison.verdict}\n{comparison.table()}")
        self.comparison = comparison


class LimitMismatch(AssertionError):
    """The limit is another one than expected, or k is too large to tell."""


@dataclass(frozen=True, eq=False)
class Part:
    """Real or imaginary part of a difference; `observed` is None where it is not judged, `silence` then says why.

    A part agrees where it falls at the expected order or faster, or where k is too large to see the order; but not
    where it takes a lower power to explain it.
    """

    name: str
    expected: float
    observed: float | None = None
    tolerance: float = TOLERANCE
    towards: int = 1
    explanation: Explanation | None = None
    silence: str = ""

    @property
    def in_order(self) -> bool:
        return self.observed is None or self.towards * (self.observed - self.expected) >= -self.tolerance

    @property
    def agrees(self) -> bool:
        if self.explanation is None:
            return self.in_order
        return not self.explanation.coefficient_differs and (self.in_order or self.explanation.k_too_large)

    @property
    def remark(self) -> str:
        """What the verdict of the whole adds of this part."""
        if self.observed is None:
            return f"{PART_NAMES[self.name]} {self.silence}"
        order = f"{PART_NAMES[self.name]} of order {self.observed:.2f}, expected {self.expected:.4g}"
        seen = self.explanation is None or abs(self.observed - self.expected) <= self.tolerance
        return order if seen else f"{order}: {self.explanation}"


@dataclass(frozen=True, eq=False)
class Comparison:
    """Numerics against a series: arrays of shape (points,), in increasing k.

    slope      local slope of log |difference| between neighbours (points - 1 values)
    observed   slope as k -> 0, from all points together
    parts      real and imaginary part by themselves
    at_least   whether a higher order agrees too: for one part alone, where the other leaves out an earlier term
    left_out   what has been left out, a sentence each
    """

    k: np.ndarray
    numeric: np.ndarray
    series: np.ndarray
    slope: np.ndarray
    observed: float
    expected: float
    tolerance: float
    parts: tuple[Part, ...] = ()
    left_out: tuple[str, ...] = ()
    at_least: bool = False

    @property
    def difference(self) -> np.ndarray:
        return np.abs(self.numeric - self.series)

    @property
    def agrees(self) -> bool:
        return self._in_order and all(part.agrees for part in self.parts)

    @property
    def _in_order(self) -> bool:
        surplus = self.observed - self.expected
        return abs(surplus) <= self.tolerance or (self.at_least and surplus > 0)

    @property
    def verdict(self) -> str:
        """One line: the order observed and expected, and if they differ what explains it."""
        points = (f"(slope of log |difference|, tolerance {self.tolerance:g}, {len(self.k)} points, "
                  f"k = {self.k[0]:g} .. {self.k[-1]:g})")
        wrong = next((part for part in self.parts if not part.agrees), None)
        if wrong is not None and wrong.observed is not None:
            return (f"observed order {wrong.observed:.4f} of the {PART_NAMES[wrong.name]} differs from the expected "
                    f"{wrong.expected:.4f}: {wrong.explanation} {points}")
        observed, expected = f"observed order {self.observed:.4f}", f"the expected {self.expected:.4f}"
        expected += " at least" * self.at_least
        remarks = "".join(f"; {part.remark}" for part in self.parts)
        return f"{observed} {'agrees with' if self._in_order else 'differs from'} {expected} {points}{remarks}"

    def table(self) -> str:
        """k, numerics, series, difference and local slope, one point a line."""
        lines = [f"{'k':>12}  {'numeric':>40}  {'series':>40}  {'error':>10}  {'slope':>7}"]
        slopes = ["", *(f"{slope:.3f}" for slope in self.slope)]
        for k, numeric, series, error, slope in zip(self.k, self.numeric, self.series, self.difference, slopes,
                                                    strict=True):
            lines.append(f"{k:12.6g}  {_complex(numeric):>40}  {_complex(series):>40}  {error:10.3e}  {slope:>7}")
        return "\n".join(lines)


def _complex(value: complex) -> str:
    return f"{value.real:.12e}" if value.imag == 0 else f"{value.real:.12e}{value.imag:+.12e}j"
