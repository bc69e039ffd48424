"""The one model: plane perturbations of a sheared layer, as four first-order equations.

With normal mode exp(i k x + sigma t) and z normal to the flow, the perturbations of velocity
(u, w), shear stress t and normal stress n obey

    w' = -i k u
    u' = (t - alpha p) / beta - i k w,                p = -n - 2 i k eta u
    t' = rho [(sigma + i k U) u + U' w] - i k n + 4 k^2 eta u
    n' = rho  (sigma + i k U) w - i k t

where rho is the inertia coefficient, eta = tau / U' the effective viscosity, beta = d tau / d U' the
tangent viscosity and alpha = d tau / d p the pressure sensitivity of the shear stress tau(U', p). No
derivative of a base-flow coefficient but U' appears, which keeps the equations regular at a free surface.

The unknowns are scaled by their long-wave orders, so that nothing cancels as k -> 0:

    u = i k^a g v,    w = k^(1+a) w^,    t = i k^a t^,    n = n^,    sigma = k^(1+a) rate

with a = 0 for perturbations along the flow and a = 1 for perturbations across it (U = alpha = 0). The
weight g(z) is 1 except where the velocity gradient itself vanishes (yield surface: g = U').
Without convection (U = 0, alpha = 0) all coefficients are real.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev as C

from ..errors import NotSmooth
from ..numerics.chebyshev import points
from ..numerics.smooth import MOST_SAMPLES, Fit, Rough, fit
from .forms import Form

FIELDS = ("v", "w", "t", "n")
ODD_WITH_W = -1, 1, 1, -1  # parity of these fields about a line of symmetry, relative to that of w

_NUMBERS = "the values of a profile must be finite real numbers, one for all points or one for each"
_EPS = np.finfo(float).eps
_NOISE = 64 * _EPS  # disagreement of a series with its function that is rounding
_HEIGHTS = 64  # at least, at which the effect of uncertain slopes is looked at
_SMOOTHEN = ("take a smooth profile, without kink, step or noise, or divide the layer there (a feature thinner than "
             "1/500 of its layer counts as a kink)")


@dataclass(frozen=True)
class Profile:
    """Base flow at the points s of a layer: arrays of the shape of s, or numbers.

    `dz` is the slope dz/ds of the map from 0 <= s <= 1 to the layer. The slopes `dU`, in z, and `dg`, in s, follow
    from the series of U and g unless they are given. The shear-rate equation is multiplied by `clear`, so that its
    coefficients become polynomials and its matrix banded.
    `rho`, `eta`, `beta` and the unknown stresses are in units of `stress`: viscous flows measure them by their
    viscosity, or else all stresses would be enormous beside the velocities at small Re.

    In the scales of the flow: `rho` density, `eta` shear stress over shear rate, `beta` the slope of the shear stress
    in the shear rate, `alpha` that in the pressure, U velocity; `g` scales the velocity along, u = i k^a g v. What is
    inconsistent raises ParameterError when the flow is solved.

    >>> import numpy as np
    >>> s = np.linspace(0, 1, 3)
    >>> Profile(dz=2.0, U=1 - (2 * s - 1)**2, eta=1e-4, beta=1e-4).U.tolist()
    [0.0, 1.0, 0.0]
    """

    dz: Any
    eta: Any
    beta: Any
    rho: Any = 1.0
    U: Any = 0.0
    dU: Any = None
    alpha: Any = 0.0
    g: Any = 1.0
    dg: Any = None
    clear: Any = 1.0
    stress: Any = 1.0

    def __post_init__(self) -> None:
        for slope, name in SLOPES.items():
            if getattr(self, slope) is None and isinstance(getattr(self, name), int | float):
                object.__setattr__(self, slope, 0.0)


SLOPES = {"dU": "U", "dg": "g"}


@dataclass(frozen=True)
class Layer:
    """A layer between two edges, s = 0 below and s = 1 above.

    `profile(s)` returns its base flow. `singular` is the number of edges at which the leading
    coefficient of the shear-rate equation vanishes: each replaces one condition (the bounded
    solution is the one that the series can represent). `steady` drops the time derivative. `growth` tells how
    many coefficients its fields are likely to need: so many for long waves, and how many more times k; without it, as
    many as in the layer that needs most.

    `name` is that of its `edges`. Heights are in L, as all else in the scales of the flow. Raises NotSmooth where a
    profile has a kink, a step or no finite values.

    >>> import numpy as np
    >>> layer = Layer("fluid", lambda s: Profile(dz=2.0, U=2 * s, eta=1.0, beta=1.0))
    >>> layer.height(np.array([0.0, 1.0])).round(12).tolist(), layer.base(np.array([0.5])).dU.round(12).tolist()
    ([0.0, 2.0], [1.0])
    >>> layer.slope("U", np.array([0.5]))[0].round(12).tolist(), layer.resolved(lambda b, s: [b.U]).length
    ([2.0], 2)
    """

    name: str
    profile: Callable[..., Profile]
    singular: int = 0
    steady: bool = False
    growth: tuple[int, float] | None = None

    def height(self, s: np.ndarray) -> np.ndarray:
        """Distance of the points 0 <= s <= 1 from the lower edge: the integral of dz/ds.

        Raises NotSmooth where dz/ds is rough.
        """
        return C.chebval(2 * s - 1, self._height)

    @cached_property
    def _height(self) -> np.ndarray:
        try:
            slope = fit(lambda s: np.broadcast_to(np.asarray(self.profile(s).dz, dtype=float), (1, len(s))))
        except Rough as rough:
            raise NotSmooth(f"layer {self.name}", f"dz is not smooth near s = {rough.s:.4g}", None, _SMOOTHEN) from None
        return C.chebint(slope.series[0], lbnd=-1) / 2

    def base(self, s: np.ndarray) -> Profile:
        """Return the profile at the points s (points,), with the slopes that follow from its series.

        Raises NotSmooth where a series that is needed does not end.
        """
        return self._completed(self.profile(s), s)[0]

    def slope(self, name: str, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the derivative in s of U or g at the points s, and a bound on its error, (points,) each.

        The series is an exact polynomial, and so is its slope: the flow of this polynomial is what is solved. The
        bound is that of the slope of the function: what the series has left out may have the highest degree that is
        looked at, rounding has its own.

        Raises NotSmooth where the series does not end.
        """
        series, cut, largest = self._series[name]
        degrees, sizes = np.array([[MOST_SAMPLES], [len(series) - 1]]), np.array([cut, _NOISE * largest])
        steepest = np.minimum(degrees / np.sqrt(np.maximum(s * (1 - s), _EPS)), 2.0 * degrees**2)
        return 2 * C.chebval(2 * s - 1, C.chebder(series)), sizes @ steepest

    @cached_property
    def _series(self) -> dict[str, tuple[np.ndarray, float, float]]:
        """Series of U and g, what they leave out at most, and their size; only of those that are no Forms."""
        found = {}
        for name in SLOPES.values():
            try:
                one = fit(lambda s, name=name: np.broadcast_to(
                    np.asarray(getattr(self._checked(s), name), dtype=float), (1, len(s))))
            except Rough as rough:
                raise self._refusal(f"{name} is not smooth", rough.s, _SMOOTHEN) from None
            found[name] = one.series[0], float(one.cut[0]), float(np.abs(one.series[0]).max())
        return found

    def _completed(self, base: "Profile", s: np.ndarray) -> "tuple[Profile, dict[Any, Any]]":
        """The profile with its slopes, and the uncertainty of those that had to be found, {name: (points,)}.

        What a series leaves out is noise: in the equations its slope acts like its last term would, without the steep
        ends of the latter, since the error of U' w integrates to that of U times the slope of w.
        """
        missing = [slope for slope in SLOPES if getattr(base, slope) is None]
        if not missing:
            return base, {}
        if any(isinstance(getattr(base, name), Form) for name in ("dz", *(SLOPES[slope] for slope in missing))):
            raise self._refusal(f"{missing[0]} must be given where heights depend on k")
        found = {slope: self.slope(SLOPES[slope], s) for slope in missing}
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = {"dU": 1 / np.asarray(base.dz), "dg": np.ones(1)}
            values = {name: value * scale[name] for name, (value, _) in found.items()}
        noise = {name: cut * len(series) * np.abs(scale[name]) for name in missing
                 for series, cut, _ in (self._series[SLOPES[name]],) if cut}
        return replace(base, **values), noise

    def resolved(self, coefficients: Callable[..., Any], together: bool = False) -> Fit:
        """Return the series of `coefficients(base, s)`, a list of arrays (points,) or numbers made of the profile at s.

        They are sampled until they have ended, as `smooth.fit` does. Raises NotSmooth where they do not, and where a
        value of the profile is not a finite real number.
        """
        uncertain: dict[str, Any] = {}

        def sample(s: np.ndarray, off: Any = None) -> np.ndarray:
            base, bounds = (off, {}) if off else self._completed(self._checked(s), s)
            uncertain.update(bounds)
            with np.errstate(divide="ignore", invalid="ignore"):
                given = coefficients(base, s)
            values = np.empty((len(given), len(s)), np.result_type(*given))
            for row, one in zip(values, given, strict=True):
                row[:] = one
            self._check("a coefficient of the equations", values, s)
            return values

        try:
            found = fit(sample, together)
        except Rough as rough:
            name, s = self._culprit(rough.s)
            raise self._refusal(f"{name} not smooth", s, _SMOOTHEN) from None
        return self._widened(found, sample) if uncertain else found

    def _widened(self, found: Any, sample: Any) -> Any:
        """The fit, with what the uncertainty of slopes that had to be found adds to what it leaves out."""
        s = points(max(found.length, _HEIGHTS))
        base, uncertain = self._completed(self.profile(s), s)
        cut = found.cut
        for name, bound in uncertain.items():
            off = replace(base, **{name: getattr(base, name) + bound})
            cut = cut + np.abs(sample(s, off) - sample(s, base)).max(axis=1)
        return replace(found, cut=cut)

    def _checked(self, s: np.ndarray) -> "Profile":
        """The profile at the points s, all of whose values are numbers or have the shape of s, real and finite."""
        base = self.profile(s)
        for name in _NAMES:
            value = getattr(base, name)
            if value is None and name in SLOPES or type(value) is float and abs(value) < np.inf:  # most are
                continue
            for one in value.terms.values() if isinstance(value, Form) else (value,):
                number = np.asarray(one)
                if number.dtype.kind not in "fiub" or number.shape and number.shape != s.shape:
                    raise self._refusal(_unfit(name, number, s))
                self._check(name, number[None], s)
        return base

    def _check(self, name: str, values: np.ndarray, s: np.ndarray) -> None:
        """Raise NotSmooth where one of the values (functions, points) or (functions,) is not finite."""
        if not np.isfinite(values).all():
            where = tuple(np.argwhere(~np.isfinite(values))[0])
            raise self._refusal(f"{name} is {values[where]}", s[where[1]] if len(where) > 1 else None)

    def _culprit(self, s: Any) -> Any:
        """Which field of the profile does not end, in words, and where; of several that do not, the first."""
        for name in _NAMES:
            if isinstance(getattr(self.base(np.array([s])), name), Form):
                continue
            try:
                fit(lambda at, name=name: np.broadcast_to(getattr(self.base(at), name), (1, len(at))))
            except Rough as rough:
                return f"{name} is", rough.s
        return "the coefficients of the equations are", s

    def _refusal(self, complaint: Any, s: Any = None, remedy: Any = None) -> Any:
        height = None
        if s is not None:
            try:
                height = float(self.height(np.array(s)))
            except (NotSmooth, TypeError, ValueError):  # the map itself is at fault, or depends on a symbol
                complaint = f"{complaint} near s = {s:.4g}"
        return NotSmooth(f"layer {self.name}", complaint, height, remedy or _NUMBERS)


_NAMES = tuple(field.name for field in fields(Profile))


def _unfit(name: Any, value: Any, s: Any) -> Any:
    """What is wrong with the type or the shape of a value of a profile."""
    if value.dtype.kind == "c":
        return f"{name} is complex"
    if value.dtype.kind not in "fiub":
        return f"{name} is no number"
    return f"{name} has the shape {value.shape} at points of the shape {s.shape}"


def numbers(flow: Any) -> Any:
    """Stand-ins for the symbols that a flow's layers may use: heights only, which C does not depend on."""
    return SimpleNamespace(k=1.0, rate=0.0, **dict.fromkeys((*flow.functions, *flow.surfaces), 1.0))


def resolved(flow: Any, layers: tuple[Any, ...], index: int, coefficients: Callable[..., Any],
             together: bool = False) -> Fit:
    """Return `Layer.resolved` of one of the layers of a flow; what it raises names the flow and a height in it."""
    try:
        return layers[index].resolved(coefficients, together)
    except NotSmooth as reason:
        bottom = flow.lowest + sum(float(layer.height(np.array(1.0))) for layer in layers[:index])
        raise reason.of(flow.name, bottom) from None


def residuals(base: Any, k: Any, rate: Any, fields: Any, slopes: Any, order: Any) -> Any:
    """Return the residuals of the four equations (shear rate, continuity, momentum along and across).

    `fields` and `slopes` are (v, w, t, n) and their s-derivatives; `order` is a of the scaling.
    All arithmetic is plain: arrays, forms, mpmath numbers and sympy symbols go through it.
    """
    v, w, t, n = fields
    dv, dw, dt, dn = slopes
    width = k ** (1 + order)
    convection = base.rho * (width * rate + 1j * k * base.U)
    u = base.g * v
    p = 2 * width * (base.eta * u) - n
    return (
        base.clear * (base.g * dv + base.dg * v - base.dz / base.beta * (t + 1j * base.alpha * p)
                      + base.dz * (k**2 * w)),
        dw - base.dz * u,
        dt - base.dz * (convection * u - 1j * base.rho * base.dU * (k * w) - k ** (1 - order) * n
                        + 4 * k**2 * (base.eta * u)),
        dn - base.dz * (width * (convection * w + t)),
    )
