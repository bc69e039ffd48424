"""Chebyshev series of functions known by their values alone, with what they leave out. No physics here.

Functions are sampled at doubling numbers of points until the series of every one of them has ended: its last quarter
is down to rounding, or to a plateau of noise where the values are good to fewer digits. Points in between, the probes,
confirm it: they see what lies between the sample points.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from . import chebyshev

MOST_SAMPLES = 4096  # sample points: what has not ended by then is a kink, a step or noise

_EPS = np.finfo(float).eps
_FIRST = 64  # sample points of the first look, three times what the flows of this package need
_SHORT = 32  # terms: what a series that ends earlier leaves out is as small as the rounding of its values
_PLATEAU = 1e-8  # root mean square of noise, relative to the largest coefficient, above which there is no function left
_FLAT = 1.6  # third over last quarter of the coefficients (root mean squares): noise 1 +- 0.3, a kink 2, a step 1.4
_NOISE = 2.0  # over the root mean square of the last quarter, that of coefficients that are more than noise
_BLOCKS = 16  # into which a series is divided to look for its end
_QUARTER = _BLOCKS // 4
_LEAST = 0.25 * _EPS  # of the largest coefficient: less is lost in the rounding of the transform
_ROUNDING = 64 * _EPS  # disagreement of a short series with the probes, relative to the largest value
_STRAY = 8.0  # disagreement with the probes in units of that with the sample points
_SAFETY = 2.0  # what is left out between the points over what is left out at them: 1.0 to 1.2, 3.8 at the steepest
_LATTICE = 987, 1597  # Fibonacci numbers, the second a prime: probes spread evenly and never meet a sample point
_PROBES = 96


class Rough(Exception):
    """The series of a function does not end; `index` tells which function, `s` where it is rough."""

    def __init__(self, index: Any, s: Any) -> None:
        super().__init__(index, s)
        self.index, self.s = index, s


@dataclass(frozen=True, eq=False)
class Fit:
    """T-coefficients of each function, `series`, as short as they may be, and `cut` (functions,): a bound on what each
    leaves out, 0 where that is no more than the rounding of the values."""

    series: tuple
    cut: np.ndarray

    @property
    def length(self) -> int:
        """Terms of the longest series."""
        return max(map(len, self.series), default=0)

    def at(self, s: np.ndarray) -> np.ndarray:
        """Return the functions at the points s, (functions, points)."""
        return np.array([np.polynomial.chebyshev.chebval(2 * s - 1, one) for one in self.series])


def fit(sample: Callable[..., Any], together: bool = False) -> "Fit":
    """Return the `Fit` of functions given by `sample(s)`: an array (functions, points) at the points 0 < s < 1.

    What is rounding is told by the largest coefficient of each function, or of all `together` (elements of a matrix).
    Raises Rough where a series has not ended at `MOST` points.
    """
    count = _FIRST
    while True:
        values = sample(np.concatenate((chebyshev.points(count), _probes()[0])))
        series = chebyshev.transform(values[:, :count])
        largest = np.abs(series).max(axis=1)
        if together:
            largest = np.full_like(largest, largest.max(initial=0))
        kept, short, ended = _kept(np.abs(series), largest)
        chopped = np.where(kept, series, 0)
        cut, met = _left_out(values, chopped, largest, short)
        if (ended & met).all():
            return Fit(_trimmed(chopped, kept), cut)
        if count == MOST_SAMPLES:
            raise _rough(values, series, chopped, ended, met)
        count *= 2


def _kept(size: Any, largest: Any) -> Any:
    """Which coefficients to keep, (functions, count); which series are short, and which have ended, (functions,)."""
    chop = chebyshev.CHOP * largest
    kept = size > chop[:, None]
    short = ~kept[:, _SHORT:].any(axis=1)
    if short.all():
        return kept, short, short
    blocks = np.sqrt(np.mean(size.reshape(len(size), _BLOCKS, -1) ** 2, axis=2))
    before, last = (np.sqrt(np.mean(blocks[:, part] ** 2, axis=1)) for part in
                    (slice(_BLOCKS // 2, -_QUARTER), slice(-_QUARTER, None)))
    flat = (last <= _PLATEAU * largest) & (before <= _FLAT * last)
    rounded = ~kept[:, -size.shape[1] // 4:].any(axis=1)
    floor = np.maximum(last, _LEAST * largest)[:, None]
    signal = np.logical_or.accumulate(blocks[:, ::-1] > _NOISE * floor, axis=1)[:, ::-1]
    longer = (size > floor) & np.repeat(signal, size.shape[1] // _BLOCKS, axis=1)
    return np.where(short[:, None], kept, longer), short, flat | rounded


def _left_out(values: np.ndarray, chopped: np.ndarray, largest: np.ndarray,
              short: np.ndarray) -> tuple[np.ndarray, ...]:
    """What the series leave out at most, (functions,), and whether they meet the probes."""
    count, every = chopped.shape[1], short.all()
    reach = _SHORT if every else count
    stray = np.abs(values[:, count:] - chopped[:, :reach] @ _probes(reach)[1]).max(axis=1)
    if every:
        return np.zeros(len(stray)), stray <= _ROUNDING * largest
    inside = np.abs(values[:, :count] - chebyshev.values(chopped)).max(axis=1)
    cut = np.where(short, 0.0, _SAFETY * np.maximum(inside, stray))
    return cut, stray <= np.maximum(_ROUNDING * largest, _STRAY * inside)


def _rough(values: Any, series: Any, chopped: Any, ended: Any, met: Any) -> Any:
    """The first function that has not ended, and where the upper half of its series (or the probes) stands out."""
    count = series.shape[1]
    index = int(np.argmin(ended & met))
    if not ended[index]:
        upper = np.where(np.arange(count) < count // 2, 0, series[index: index + 1])
        return Rough(index, float(chebyshev.points(count)[np.argmax(np.abs(chebyshev.values(upper)))]))
    stray = np.abs(values[index, count:] - chopped[index] @ _probes(count)[1])
    return Rough(index, float(_probes()[0][np.argmax(stray)]))


@lru_cache(maxsize=8)
def _probes(count: int = 1) -> tuple[np.ndarray, ...]:
    """Points (probes,) between the sample points, and T_0 .. T_{count-1} at them, (count, probes)."""
    step, prime = _LATTICE
    angle = step * np.arange(1, _PROBES + 1) % prime
    angles = np.outer(np.arange(count), angle) % (2 * prime)
    return (1 + np.cos(np.pi * angle / prime)) / 2, np.cos(np.pi * angles / prime)


def _trimmed(series: Any, kept: Any) -> Any:
    """Every series up to its last term, real where it is real; 0 where there is none."""
    ends = (kept.shape[1] - kept[:, ::-1].argmax(axis=1)) * kept.any(axis=1)
    imaginary = series.imag.any(axis=1) if np.iscomplexobj(series) else np.zeros(len(series), bool)
    return tuple((one if turned else one.real)[:max(end, 1)]
                 for one, end, turned in zip(series, ends.tolist(), imaginary.tolist(), strict=True))
