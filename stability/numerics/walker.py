"""Steps along a way: each is foreseen, corrected and checked, and a shorter one is tried where it fails.

This is the one control of steps there is: for modes along k, for crests, zeros and neutral curves along a parameter,
and for solutions of boundary-value problems. What lies on the way, and by what a step is judged, those say who walk.
"""

from dataclasses import dataclass
from math import copysign, exp, log
from typing import Any, ClassVar

from ..errors import ModeLost


@dataclass(frozen=True)
class Pace:
    """Lengths of steps: the first, the largest and the smallest, and how many times shorter one is after a failure."""

    first: float
    largest: float
    smallest: float
    cut: float = 3.0


class Walker:
    """The length of the next `step` of a walk, and how a step is taken.

    Subclasses say how the place ahead is foreseen from those behind (`foresee`), corrected to one that belongs to the
    way (`correct`, which may raise `failures`), what it has to pass (`checks`, names of methods) and by
    which factor the next step may be longer (`factor`), and keep it (`accept`).
    """

    checks: ClassVar[tuple[str, ...]] = ()
    failures: ClassVar[tuple[type[Exception], ...]] = (ModeLost,)

    def __init__(self, pace: Pace) -> None:
        self.pace, self.step = pace, pace.first

    def foresee(self, to: Any) -> Any:
        """Return the guess at a place."""
        return None

    def correct(self, to: Any, guess: Any) -> Any:
        """Return what is found at a place next to a guess; None, or an exception, where nothing is."""
        raise NotImplementedError

    def factor(self, new: Any, guess: Any) -> float:
        """Return how much longer the next step may be, given what was foreseen."""
        return 2.0

    def accept(self, to: Any, new: Any) -> None:
        """Go on from what was found."""
        raise NotImplementedError

    def stride(self, to: Any, length: float) -> bool:
        """Try a step of this length to a place; return whether it was taken. If not, the next one is shorter."""
        guess = self.foresee(to)
        try:
            new = self.correct(to, guess)
        except self.failures:
            new = None
        if new is None or not all(getattr(self, check)(new, guess) for check in self.checks):
            self.step = length / self.pace.cut
            return False
        factor = self.factor(new, guess)
        self.accept(to, new)
        self.step = min(self.pace.largest, max(length, self.step) * factor)
        return True

    @property
    def stuck(self) -> bool:
        """Whether even the smallest step fails."""
        return self.step < self.pace.smallest


def towards(now: float, end: float, step: float) -> tuple[float, float]:
    """Where one comes from a positive number to another with a step in its logarithm, and the length of that step."""
    gap = log(end / now)
    return (end, abs(gap)) if abs(gap) <= step else (now * exp(copysign(step, gap)), step)


