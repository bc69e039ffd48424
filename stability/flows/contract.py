"""What a class of flows must be: checked when it is written, when it is asked for, and when its base flow is known.

Whatever is given twice is compared: a slope with the series of what it is the slope of, at every height. The flows of
this package are checked by its tests, those from elsewhere whenever a solver is made for one of them.
"""

from dataclasses import Field
from functools import lru_cache
from inspect import Parameter, signature
from typing import Any

import numpy as np

from ..checks import shown
from ..equations.forms import Form
from ..equations.layer import SLOPES, Layer, Profile, numbers
from ..errors import NotSmooth, ParameterError
from ..numerics import chebyshev
from . import sources

OPTIONS = frozenset((  # of the command line, by their names there
    "csv", "delta", "each", "flow", "form", "given", "help", "json", "k", "law", "log", "long_wave", "max_degree",
    "method", "mode", "modes", "output", "over", "overlay", "panel", "parameters", "plot", "points", "port", "quantity",
    "quiet", "range", "run", "search", "size", "style", "title", "tolerance", "vary", "version", "web", "workers",
))
HEADINGS = frozenset((  # of results and their files
    "flow", "parameters", "method", "version", "notes", "rows", "source", "digest", "mode", "title", "scales",
    "convention",
))
SYMBOLS = frozenset(("k", "rate", "sigma", "c", "s"))

_METHODS = {"layers": 1, "conditions": 2, "evaluate": 1, "long_wave": 1, "halves": 0}  # arguments beside self
_HEIGHTS = 192  # heights at which signs are looked at and slopes compared: features are resolved by fewer points
_POSITIVE = "dz", "eta", "beta", "stress"
_WAVENUMBERS = np.array([0.1, 1.0, 10.0])  # at which the slopes of functions of k are compared
_STEP = 1e-4  # of their differences, relative
_ALIKE = 1e-6  # relative difference of two slopes that are the same: differences of step 1e-4 are good to 1e-8
_DIGITS = 1e-9  # of the largest: disagreement of a slope with a series that is lost in the eighth digit of sigma


# -- the class, as it is written --------------------------------------------------------------------------------------

def check_body(cls: type) -> None:
    """Refuse what no class of flows may have in its body; called as the class is made, before `dataclass` is."""
    own = vars(cls)
    kinds = own.get("__annotations__", {})
    for name, kind in kinds.items():
        if "ClassVar" not in str(kind):
            _check_declared(cls, name, own.get(name))
    for name, value in own.items():
        if isinstance(value, Field) and name not in kinds:
            raise ParameterError(f"{cls.__name__}.{name}: parameters carry a type: {name}: float = parameter(...)")
    _check_words(cls, own)
    for name, count in _METHODS.items():
        if callable(own.get(name)):
            _check_arguments(cls, name, own[name], count)


def _check_declared(cls: type, name: str, value: Any) -> None:
    if not isinstance(value, Field) or "meaning" not in value.metadata:
        example = shown(value) if isinstance(value, int | float) else "1.0"
        raise ParameterError(f"{cls.__name__}.{name}: declare it as a parameter, {name}: float = parameter({example}, "
                             f'meaning="..."), or as a constant, {name}: ClassVar[...] = ...')
    root = cls.__mro__[-2]  # of all flows
    reason = "an option of the command line" if name in OPTIONS else "a heading of results" if name in HEADINGS else \
        "a symbol" if name in SYMBOLS | _symbols(cls) else "an attribute of flows" if hasattr(root, name) else None
    if reason and not sources.shipped(cls):
        raise ParameterError(f"{cls.__name__}.{name}: a parameter cannot be named {name}: that is {reason}")


def _symbols(cls: type) -> frozenset[str]:
    named = (getattr(cls, "surfaces", ()), getattr(cls, "functions", ()))
    return frozenset(name for names in named if isinstance(names, tuple) for name in names)


def _check_words(cls: type, own: Any) -> None:
    """The class attributes that a body gives as constants."""
    name = own.get("name", "-")
    if not isinstance(name, str | property) or isinstance(name, str) and (not name or set(name) & set(" :/\\\t\n")):
        raise ParameterError(f"{cls.__name__}.name: must be a word without spaces, : and / (got {shown(name)})")
    for attribute, allowed in (("order", (0, 1)), ("reflection", (-1, 0, 1))):
        value = own.get(attribute, 0)
        if not isinstance(value, property) and value not in allowed:
            raise ParameterError(f"{cls.__name__}.{attribute}: must be one of {', '.join(map(str, allowed))} "
                                 f"(got {shown(value)})")
    for attribute in ("surfaces", "functions"):
        value = own.get(attribute, ())
        words = isinstance(value, tuple) and all(isinstance(one, str) and one.isidentifier() for one in value)
        if not isinstance(value, property) and not words:
            raise ParameterError(f'{cls.__name__}.{attribute}: must be a tuple of names, such as ("s0",) '
                                 f"(got {shown(value)})")


def _check_arguments(cls: type, name: str, method: Any, count: int) -> None:
    given = [one for one in signature(method).parameters.values() if one.kind in
             (Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD) and one.default is Parameter.empty]
    if len(given) != count + 1 and not any(one.kind is Parameter.VAR_POSITIONAL
                                           for one in signature(method).parameters.values()):
        expected = {"conditions": "self, edges, names", "layers": "self, names", "halves": "self"}.get(name, "self, k")
        raise ParameterError(f"{cls.__name__}.{name}: takes ({expected}) "
                             f"(got ({', '.join(one.name for one in given)}))")


# -- the flow, with its base flow -------------------------------------------------------------------------------------

def verify(flow: Any) -> None:
    """Raise a ParameterError where what a flow says of its base flow and its functions of k cannot be so."""
    with sources.faults():
        try:
            _verified(flow)
        except TypeError as reason:
            if "unhashable" not in str(reason):
                raise
            _verified.__wrapped__(flow)


@lru_cache(maxsize=256)
def _verified(flow: Any) -> None:
    layers = flow.layers(numbers(flow))
    if not isinstance(layers, tuple | list) or not layers or not all(isinstance(one, Layer) for one in layers):
        raise ParameterError(f"{flow.name}: layers(names) must return a tuple of Layers, (Layer(...),) "
                             f"(got {shown(layers)})")
    labels = [layer.name for layer in layers]
    if len(set(labels)) < len(labels) or not all(isinstance(one, str) and one.isidentifier() for one in labels):
        raise ParameterError(f"{flow.name}: layers must have different names, which are words (got {shown(labels)})")
    bottom = flow.lowest
    for layer in layers:
        try:
            bottom += _check_layer(layer, bottom)
        except NotSmooth as reason:
            raise reason.of(flow.name, bottom) from None
        except ParameterError as reason:
            raise ParameterError(f"{flow.name}: layer {layer.name}: {reason}") from None
    _check_functions(flow)


def _check_layer(layer: Layer, bottom: float) -> float:
    """Look at the profile of a layer at many heights; return its thickness."""
    s = chebyshev.points(_HEIGHTS)
    given = layer.profile(s)
    if not isinstance(given, Profile):
        raise ParameterError(f"its profile must return a Profile (got {shown(given)})")
    base = layer.base(s)
    if not any(isinstance(getattr(base, name), Form) for name in ("dz", "U", "g")):
        _check_signs(base, s, lambda index: bottom + layer.height(s[index]))
        for name in SLOPES:
            if getattr(given, name) is not None and not isinstance(getattr(given, name), Form):
                _check_slope(layer, given, name, s, bottom)
    return float(layer.height(np.array(1.0)))


def _check_signs(base: Profile, s: np.ndarray, height: Any) -> None:
    """eta, beta and the map are positive, inertia is not negative, what an equation is multiplied by has no zero."""
    for name in (*_POSITIVE, "rho", "clear", "g"):
        value = np.broadcast_to(getattr(base, name), s.shape)
        sign = value * np.sign(value[np.argmax(np.abs(value))]) if name in ("clear", "g") else value
        wrong = sign < 0 if name == "rho" else sign <= 0
        if wrong.any():
            index = int(np.argmax(wrong))
            rule = {"rho": "must not be negative", "clear": "must not change its sign", "g": "must not change its sign",
                    "dz": "must be positive, s = 0 is below"}.get(name, "must be positive")
            raise ParameterError(f"{name} {rule}: it is {value[index]:.6g} at z = {height(index):.4g}")


def _check_slope(layer: Layer, given: Profile, name: str, s: np.ndarray, bottom: float) -> None:
    """Compare dU or dg with the series of U or g."""
    value = np.broadcast_to(getattr(given, name), s.shape)
    expected, uncertain = layer.slope(SLOPES[name], s)
    if name == "dU":
        expected, uncertain = expected / given.dz, uncertain / np.abs(given.dz)
    largest = max(np.abs(expected).max(), np.abs(value).max())
    off = np.abs(value - expected) - uncertain
    index = int(np.argmax(off))
    if off[index] > _DIGITS * largest:
        of = f"the slope of {SLOPES[name]} {'in z' if name == 'dU' else 'in s'}"
        raise ParameterError(f"{name} contradicts {of}: at z = {bottom + layer.height(s[index]):.4g} it is "
                             f"{value[index]:.6g}, the slope {expected[index]:.6g}"
                             + ("; leave it out: it follows" if name == "dU" else ""))


def _check_functions(flow: Any) -> None:
    """The functions of k: all of them, finite, each with its slope."""
    k = _WAVENUMBERS
    found = flow.evaluate(k)
    if set(found) != set(flow.functions):
        raise ParameterError(f"{flow.name}: evaluate(k) must return {{name: (value, slope, error)}} for the functions "
                             f"{', '.join(flow.functions) or '(none)'} (got {', '.join(map(str, found)) or 'none'})")
    if not found:
        return
    ahead, behind = flow.evaluate(k * (1 + _STEP)), flow.evaluate(k * (1 - _STEP))
    for name, triple in found.items():
        if len(triple) != 3 or any(np.shape(part) != k.shape for part in triple):
            raise ParameterError(f"{flow.name}: evaluate(k)[{name!r}] must be (value, slope, error), arrays like k")
        value, slope, error = map(np.asarray, triple)
        if not all(np.isfinite(part).all() for part in (value, slope, error)) or np.any(error < 0):
            raise ParameterError(f"{flow.name}: {name} must be finite, its error not negative (at k = 0.1, 1 and 10)")
        differenced = (ahead[name][0] - behind[name][0]) / (2 * _STEP * k)
        noise = error / (_STEP * k) + _ALIKE * np.maximum(np.abs(differenced), np.abs(value) / k)
        wrong = np.abs(slope - differenced) > noise
        if wrong.any():
            index = int(np.argmax(wrong))
            raise ParameterError(f"{flow.name}: the slope of {name} in k contradicts its values: at k = {k[index]:g} "
                                 f"it is {slope[index]:.6g}, differences give {differenced[index]:.6g}")
