"""How accurate an answer has to be: one value that travels from the question down to the solver."""

from dataclasses import dataclass, replace
from typing import Any

from ..checks import check_integer, check_tolerance

DEGREES = (8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 128, 160, 192, 256, 320,
           384, 512)
TOLERANCE = 1e-10  # default bound on error / |sigma| for a resolved mode


@dataclass(frozen=True)
class Accuracy:
    """The relative error of sigma that counts as resolved, and the largest Chebyshev degree that is tried.

    >>> Accuracy(1e-6, 100).degrees[-1], Accuracy(1e-6).rougher(1e-8).tolerance
    (96, 1e-06)
    """

    tolerance: float = TOLERANCE
    max_degree: int = DEGREES[-1]

    @property
    def degrees(self) -> tuple[int, ...]:
        """The degrees that are tried, by increasing size."""
        return tuple(degree for degree in DEGREES if degree <= self.max_degree) or (self.max_degree,)

    @property
    def settings(self) -> dict[str, Any]:
        """What the header of a result says of it; the keyword arguments of the public functions."""
        return {"tolerance": self.tolerance, "max_degree": self.max_degree}

    def rougher(self, tolerance: float) -> "Accuracy":
        """Return the same, but no more accurate than this."""
        return replace(self, tolerance=max(self.tolerance, tolerance))


USUAL = Accuracy()


def check_accuracy(tolerance: float, max_degree: int,
                   names: tuple[str, str] = ("tolerance", "max_degree")) -> Accuracy:
    """Return both as one value, or raise a ParameterError that uses these names."""
    return Accuracy(check_tolerance(tolerance, names[0]),
                    check_integer(max_degree, names[1], DEGREES[0], DEGREES[-1]))
