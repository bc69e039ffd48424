"""The least stable modes at one wavenumber, none missing and none twice.

Dense spectra, one for each symmetry class, are repeated at rising degrees until all modes above a line in the plane of
rates agree one to one; each is then refined. Whether any was overlooked is asked of something else: the determinant
of A - rate B counts by its winding along a contour (the argument principle) how many eigenvalues lie above the line.
Divided by the product of (rate - eigenvalue) of those that are known it does not turn where the list is complete, so
that a few points suffice; it turns once for each that is missing. Where the determinant from band factors turns (they
lose digits in strongly sheared layers), that of the full matrix decides.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ModeLost, naming
from ..status import doubtful, is_resolved
from .accuracy import DEGREES
from .cutoff import belongs_to_cut
from .dense import dense_degrees, finite_rates, unknowns
from .winding import winding

if TYPE_CHECKING:
    from .mode import Mode
    from .solver import Solver

FIRST = 6  # rung of the degrees at which a look starts
_MORE = 10  # eigenvalues beside twice the number asked for that are tried where they do not settle
_LOWEST = 3  # rung below which a look at modes near zero growth does not start
_SPARE = 3  # eigenvalues behind the last one asked for among which the widest gap is taken for the line
_DRIFT = 1e-4  # relative difference of a rate between two degrees that counts as settled
_ALIKE = 1e-9  # difference of growth, relative to the rate, that may be rounding where it lies within the errors
_LEAP = 0.05  # largest relative distance of a refined rate from the dense one
_FAILURES = 3  # degrees at which a settled list may be found incomplete before that is said
_COSTLY = 400  # unknowns of a dense problem beyond which a part of the depth asked for may do
_BASE = 0.5, 0.3  # degree over terms of the base flow from which on modes of an unbounded fluid are listed; looked at
_FRUITLESS = 5  # looks at an unbounded fluid after which it is taken to have no modes


@dataclass(frozen=True)
class Listing:
    """The modes found, by decreasing growth rate: before and among the first `sure` of them none is missing.

    `doubt` says why others may be missing behind those, or is None.
    """

    modes: tuple
    sure: int
    doubt: str | None

    @property
    def status(self) -> tuple[Any, ...]:
        """Of each mode; where others may be missing, that instead of "resolved"."""
        return tuple(doubtful(str(self.doubt)) if rank >= self.sure and is_resolved(mode.status) else mode.status
                     for rank, mode in enumerate(self.modes))


class _Class:
    """One symmetry class at a wavenumber: its `solver`, the dense `rates` of the last degree and those before.

    Rates of a continuous spectrum, which a cut makes discrete, are no modes: they are kept apart as `unbound`, and so
    is, in an unbounded fluid, what decays and does not settle.
    """

    def __init__(self, solver: "Solver", k: float) -> None:
        self.solver, self.k = solver, k
        self.rates, self.before, self.degree = np.empty(0, complex), np.empty(0, complex), 0
        self.unbound, self.seen, self.earlier, self.looks = (*(np.empty(0, complex) for _ in range(3)), 0)
        self.symbols = solver.symbols(k)

    def look(self, degree: int) -> None:
        rates = finite_rates(self.solver, degree, self.symbols)
        bound = self.solver.flow.bound(self.k, self.solver.width(self.k) * rates)
        before, self.seen, self.looks, self.earlier = self.seen, rates[bound], self.looks + 1, self.rates
        if self.looks < 3 or not self.solver.flow.unbounded:
            self.enough = degree
        self.degree, self.before, self.rates, self.unbound = degree, before, self.seen, rates[~bound]
        if self.solver.flow.unbounded and self.looks > 1:
            stays = _kept(self.seen, before)
            self.rates, self.before = self.seen[stays], before[_kept(before, self.seen)]
            self.unbound = np.concatenate((self.unbound, self.seen[~stays]))

    def settled(self, line: float) -> bool:
        """Whether the rates above the line are, one to one, those of the degree before."""
        if self.looks < 2:
            return False
        now, before = (rates[rates.real > line] for rates in (self.rates, self.before))
        return _paired(now, self.before) and _paired(before, self.rates)

    def steady(self, count: int) -> bool:
        """Whether, in an unbounded fluid, the leading modes that have settled were the leading ones before as well."""
        if not self.solver.flow.unbounded:
            return True
        first, before = (rates[np.argsort(-rates.real)][:count] for rates in (self.rates, self.earlier))
        return self.looks > 2 and len(first) == len(before) and _paired(first, before)

    def refined(self, line: float) -> list[Any]:
        """The modes above the line; None in place of those that the iteration leaves; those of a cut are put aside."""
        above = self.rates.real > line
        modes = self._each(self.rates[above])
        if self.solver.flow.unbounded:
            cut = np.array([belongs_to_cut(self.solver, mode) if mode else rate.real < 0
                            for mode, rate in zip(modes, self.rates[above], strict=True)], dtype=bool)
            self.unbound = np.concatenate((self.unbound, self.rates[above][cut]))
            modes = [mode for mode, aside in zip(modes, cut, strict=True) if not aside]
        return modes

    def _each(self, rates: np.ndarray) -> "list[Mode | None]":
        """The modes to which these rates lead; where one has needed a larger degree, those after it start there."""
        modes: list[Mode | None] = []
        degree = self.enough
        for rate in rates:
            modes.append(self._refined(rate, degree))
            degree = max(degree, modes[-1].degree if modes[-1] else 0)
        return modes

    def _refined(self, rate: complex, degree: int) -> "Mode | None":
        try:
            mode = self.solver.solve(self.k, rate, None, degree)
        except ModeLost:
            return None
        return mode if abs(mode.rate - rate) < _LEAP * abs(rate) else None

    def tried(self, line: Any) -> Any:
        """Modes to which the rates above the line lead, or those of the degree before did."""
        rates = np.concatenate((self.rates, self.before))
        return [self._refined(rate, self.enough) for rate in rates[rates.real > line]]

    def missing(self, modes: list[Any], line: float) -> int:
        """How many eigenvalues above the line are not among these modes."""
        known = np.array([mode.rate for mode in modes], dtype=complex)
        below = self.rates[self.rates.real <= line]
        return winding(self.solver, self.degree, self.k, np.concatenate((known, below, self.unbound)), line)


def listed(solver: "Solver", k: float, count: int) -> "Listing":
    """Return the `Listing` of at least the `count` least stable modes at wavenumber k.

    Raises ModeLost where no mode settles.
    """
    try:
        return _listed(solver, k, count)
    except ModeLost as reason:
        raise ModeLost(naming(solver.flow, f"k = {k:g}: {reason}")) from None


def _listed(solver: "Solver", k: float, count: int) -> "Listing":
    classes, failures = [_Class(half, k) for half in solver.halves], 0
    part = classes[0].solver
    for degree in dense_degrees(part, _rung(part, FIRST, _BASE[0]), 2):
        for one in classes:
            one.look(degree)
        if not len(_all_rates(classes)):  # no mode of an unbounded fluid is known yet
            if classes[0].looks > _FRUITLESS:
                break
            continue
        line = _line(_all_rates(classes), count)
        if all(one.settled(line) and one.steady(count) for one in classes):
            found = _found(classes, line, degree)
            failures += 1
            if found.doubt is None or failures == _FAILURES:
                return _checked(solver, found, count, degree)
    return _checked(solver, _as_far_as_settled(classes, count, degree), count, degree)


def _rung(solver: "Solver", first: int, part: float) -> int:
    """The rung to start from, `first` where all coefficients count: where what does not settle is put aside, one at
    which the base flow is resolved."""
    least = solver.rung_degree(DEGREES[first])
    if solver.flow.unbounded:
        least = max(least, min((degree for degree in solver.degrees
                                if degree >= part * solver.assembly.system.longest), default=0))
    return solver.degrees.index(least)


def _all_rates(classes: "list[_Class]") -> np.ndarray:
    return np.concatenate([one.rates for one in classes])


def _found(classes: "list[_Class]", line: float, degree: int) -> "Listing":
    """The `Listing` of all modes above a line."""
    refined = [one.refined(line) for one in classes]
    modes = _sorted([mode for part in refined for mode in _distinct(part)])
    doubt = _doubt(classes, refined, line, degree)
    return Listing(modes, 0 if doubt else len(modes), doubt)


def _as_far_as_settled(classes: Any, count: Any, degree: int) -> Any:
    """The listing where the modes asked for do not settle: a sure part, if there is one, and the others behind it."""
    rates = _all_rates(classes)
    if not len(rates):
        return Listing((), 0, None)
    doubt = f"the least stable modes do not settle up to degree {degree}"
    known = [[] if one.solver.flow.unbounded else _distinct(one.tried(_line(rates, 2 * count + _MORE)))
             for one in classes]
    growth = np.sort(rates.real)[::-1]
    for behind in range(min(count + _SPARE, len(growth) - 1), 0, -1):
        line = (growth[behind - 1] + growth[behind]) / 2
        if all(one.settled(line) for one in classes):
            part = _found(classes, line, degree)
            if part.sure:
                return _joined(part.modes, known, doubt)
    return _joined((), known, doubt)


def _joined(sure: Any, known: Any, doubt: Any) -> Any:
    """A listing of sure modes and, behind them, the others that are known."""
    others = [mode for modes in known for mode in modes if not any(same(mode, other) for other in sure)]
    return Listing((*sure, *_sorted(others)), len(sure), doubt)


def _sorted(modes: "list[Mode]") -> tuple[Any, ...]:
    """By decreasing growth; of modes that grow alike, as mirror images do, first the one that travels downstream
    faster, whichever growth rounding has made the larger."""
    alike: list[list[Mode]] = []
    for mode in sorted(modes, key=lambda mode: -mode.growth_rate):
        last = alike[-1][-1] if alike else None
        if last and last.growth_rate - mode.growth_rate <= min(last.error + mode.error, _ALIKE * abs(mode.sigma)):
            alike[-1].append(mode)
        else:
            alike.append([mode])
    return tuple(mode for group in alike for mode in sorted(group, key=lambda mode: -mode.phase_speed))


def _checked(solver: "Solver", found: "Listing", count: int, degree: int) -> "Listing":
    """The listing, doubtful where it has fewer than `count` modes; raises ModeLost where it has none."""
    if not found.modes:
        raise ModeLost(f"no mode settles up to degree {degree}")
    if len(found.modes) < count:
        if solver.flow.unbounded and found.doubt is None:
            return replace(found, doubt=f"{len(found.modes)} of {count} modes are found up to degree {degree}: the "
                                        "others would belong to the continuous spectrum of the unbounded fluid")
        doubt = f"{len(found.modes)} of {count} modes are found up to degree {degree}"
        return replace(found, sure=0 if found.doubt is None else found.sure,
                       doubt="; ".join(filter(None, (found.doubt, doubt))))
    return found


def leading_modes(solver: "Solver", k: Any, count: Any) -> Any:
    """Return the `count` least stable modes as a list; unresolved ones carry that status, or that others may lead.

    Raises ModeLost where none of them settles.
    """
    found = listed(solver, k, count)
    return [replace(mode, status=status) for mode, status in zip(found.modes, found.status, strict=True)][:count]


def near_neutral(solver: "Solver", k: float, depth: float, rung: int) -> tuple[Any, ...]:
    """Return all modes whose rates decay no faster than `depth`, and a rung to start from next.

    Where that takes a large dense problem, a part of the depth may do. Raises ModeLost where they do not settle.
    """
    one = _Class(solver, k)
    degrees = dense_degrees(solver, max(rung, _rung(solver, _LOWEST, _BASE[1])), 1)
    for degree in degrees:
        one.look(degree)
        costly = unknowns(solver, degree) > _COSTLY
        for line in (-depth, -depth / 4, -depth / 16) if costly else (-depth,):
            if one.settled(line):
                modes = one.refined(line)
                if None not in modes:
                    return modes, max(0, solver.degrees.index(degree) - 1)
    raise ModeLost(f"{solver.flow}, k = {k:g}: the least stable modes do not settle up to degree {degrees[-1]}")


def _line(rates: np.ndarray, count: int) -> float:
    """A growth rate below the `count` leading ones, in the widest gap among the next few."""
    growth = np.sort(rates.real)[::-1]
    gaps = -np.diff(growth[count - 1: count + _SPARE])
    if not len(gaps):
        return growth[-1] - abs(growth[-1])
    widest = count - 1 + int(np.argmax(gaps))
    return (growth[widest] + growth[widest + 1]) / 2


def _paired(rates: np.ndarray, others: np.ndarray) -> bool:
    """Whether each rate has an other one of its own within the drift allowed."""
    if not len(rates) or not len(others):
        return not len(rates)
    distance = np.abs(rates[:, None] - others)
    nearest = distance.argmin(axis=1)
    return len(set(nearest.tolist())) == len(rates) and bool(np.all(distance.min(axis=1) < _DRIFT * np.abs(rates)))


def _kept(rates: Any, others: Any) -> Any:
    """Which rates grow, or have an other one within the drift allowed."""
    near = np.abs(rates[:, None] - others).min(axis=1, initial=np.inf) < _DRIFT * np.abs(rates)
    return (rates.real >= 0) | near


def _distinct(modes: list[Any]) -> list[Any]:
    """The modes that are there, each once: two are the same where their error bars meet."""
    kept = []
    for mode in modes:
        if mode is not None and not any(same(mode, other) for other in kept):
            kept.append(mode)
    return kept


def same(mode: "Mode", other: "Mode") -> bool:
    return abs(mode.sigma - other.sigma) <= mode.error + other.error


def _doubt(classes: "list[_Class]", refined: list[Any], line: float, degree: int) -> Any:
    """Why modes above the line may be missing from those refined in each class, or None."""
    for one, modes in zip(classes, refined, strict=True):
        if len(_distinct(modes)) < len(modes):
            return f"dense eigenvalues at degree {degree} lead to no mode of their own"
        missing = one.missing(modes, line)
        if missing:
            return f"the determinant counts {missing:+d} at degree {degree}"
    return None
