"""What every flow is: a frozen dataclass of numbers with layers, conditions and a long-wave limit."""

from collections.abc import Callable
from dataclasses import Field, dataclass, field, fields
from math import inf, isinf
from typing import TYPE_CHECKING, Any, ClassVar

from ..checks import shown
from ..equations.layer import Profile
from ..errors import ParameterError
from . import sources
from .contract import check_body, verify
from .rules import check_parameter, check_varied

_INSET, _AROUND = 1e-3, 100.0  # of a bounded range left out at its ends; factor about the default of an unbounded one


def parameter(default: float, low: float | None = None, high: float | None = None, *, meaning: str, reason: str = "",
              closed: bool = False, unbounded: bool = False, look: tuple[float, float] | None = None,
              symbol: str | None = None) -> Any:
    """Declare a numeric parameter with its open range low < value < high, its meaning and the reason.

    `closed` admits `low` itself as a value, `unbounded` admits inf (and -inf where there is no `low`). Neutral values
    are looked for in the range `look`. `symbol` is what figures call it, in TeX, if that is not its name.

    Returns a dataclass field. Numbers are in the units that `meaning` names. The flow raises ParameterError for values
    outside.

    >>> from dataclasses import dataclass
    >>> from stability.flows import Flow
    >>> @dataclass(frozen=True)
    ... class Calm(Flow):
    ...     name = "calm"
    ...     Re: float = parameter(100.0, 0, meaning="Reynolds number of depth and surface speed")
    ...     def layers(self, names):
    ...         return ()
    ...     def conditions(self, edges, names):
    ...         return ()
    >>> Calm(Re=5).Re
    5.0
    """
    return field(default=default, metadata={"low": low, "high": high, "meaning": meaning, "reason": reason,
                                            "closed": closed, "unbounded": unbounded, "look": look, "symbol": symbol})


def choice(*options: str, meaning: str) -> Any:
    """Declare a parameter that takes one of a few names; the first is the default.

    A name has no units. The flow raises ParameterError for any other one.

    >>> choice("wall", "free", meaning="upper edge").default
    'wall'
    """
    return field(default=options[0], metadata={"options": options, "meaning": meaning})


def table_parameter(default: str, read: Callable[[str, Any], Any], *, kinds: str, meaning: str) -> Any:
    """Declare a parameter that is a value of its own, such as a file of data: `read(name, value)` makes it from what is
    given, or raises a ParameterError; `kinds` says what that may be."""
    return field(default=default, metadata={"table": True, "read": read, "kinds": kinds, "meaning": meaning})


@dataclass(frozen=True)
class Flow:
    """A parallel base flow as a boundary-value problem in (k, sigma).

    A subclass gives `layers(names)` and `conditions(edges, names)`, where `names` holds the symbols k,
    rate, its `surfaces` (amplitudes of displaced surfaces) and its `functions` of k; `edges.<layer>` is
    the pair of edges (s = 0, s = 1) with their fields v, w, t, n. See `equations.layer` for the scaling.

    Lengths, velocities and stresses are in the scales that `scales` names. Raises ParameterError, in one line, for a
    parameter outside its range and where the class contradicts itself.

    >>> from stability import flows
    >>> flow = flows.Film(Re=20.0)
    >>> isinstance(flow, Flow), flow.stated(), flow.has_surface_mode()
    (True, {'Re': 20.0, 'slope_deg': 30.0, 'We': 0.0}, True)
    >>> flow.long_wave(0.001), flow.state("fluid", 1.0, flow.layers(None)[0].profile(1.0))["U"]
    (-0.002j, 1.0)
    """

    name: ClassVar[str]
    title: ClassVar[str] = "no title"
    scales: ClassVar[str] = "those of its base flow"
    order: ClassVar[int] = 0  # sigma = k^(1 + order) * rate
    surfaces: ClassVar[tuple[str, ...]] = ()
    functions: ClassVar[tuple[str, ...]] = ()
    if TYPE_CHECKING:
        bottom: ClassVar[float]

        def layers(self, names: Any) -> tuple[Any, ...]: ...

        def conditions(self, edges: Any, names: Any) -> tuple[Any, ...]: ...
    else:  # not annotated: else it would come first among the parameters of a flow that has one of this name
        bottom = 0.0  # z of the lowest edge
    wavenumber: ClassVar[float] = 1.0  # at which the mode leads that is followed where there is no surface mode
    decays: ClassVar[bool] = False  # whether it is known that all modes of all such flows decay
    unbounded: ClassVar[bool] = False  # whether the fluid is cut where it should go on to infinity
    data: ClassVar[Any] = None  # what was measured: `basis(z)`, `slopes(z)` and `covariance` of the terms of U
    chopped: ClassVar[float] = 0.0  # bound on what a series that stands for U leaves out of it
    reflection: ClassVar[int] = 0  # of w about the middle of the only layer, 1 even or -1 odd: modes of one parity

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        sources.note(cls)
        check_body(cls)

    def __post_init__(self) -> None:
        if not sources.shipped(type(self)):
            check_class(type(self))
        for item in fields(self):
            value = check_parameter(self.name, item, getattr(self, item.name))
            object.__setattr__(self, item.name, value)

    def __reduce__(self) -> Any:
        """Pickle a flow by its parameters; a class from a file is found again by the file."""
        values = {item.name: getattr(self, item.name) for item in fields(self)}
        return sources.revive, (sources.ticket(type(self)), values)

    def evaluate(self, k: Any) -> dict[str, tuple[Any, Any, Any]]:
        """Return {name: (value, slope in k, absolute error)} of the functions of k, arrays like k.

        Raises nothing; `k` in 1/L. An example is `stability/flows/dune.py`: `flow.evaluate(k)`.
        """
        return {}

    def long_wave(self, k: Any) -> Any:
        """Return the leading-order growth rate sigma of the slow surface mode as k -> 0.

        Raises ParameterError where there is none; `k` in 1/L, sigma in V/L.
        """
        raise ParameterError(f"{self.name} has no slow surface mode: ask for mode most-unstable")

    def state(self, layer: str, z: Any, base: Profile) -> dict[str, Any]:
        """Return what is shown of the base flow of a layer at the heights z (points,), {name: number or (points,)}.

        At least U, dU and shear_stress; others may follow, such as pressure and inertial_number.

        Raises nothing; in the scales of the flow.
        """
        return {"U": base.U, "dU": base.dU, "shear_stress": base.stress * base.eta * base.dU}

    def stated(self) -> dict[str, Any]:
        """Return the parameters as numbers and texts that tell this flow from all others, for headers of results."""
        return {item.name: getattr(self, item.name) for item in fields(self)}

    def remarks(self) -> list[str]:
        """Return what else there is to know of the base flow, a sentence each."""
        return []

    def halves(self) -> "tuple[Flow, ...]":
        """Return flows whose modes together are those of this one: itself, or its symmetry classes."""
        return (self,)

    @property
    def lowest(self) -> float:
        """z of the lowest edge of its layers."""
        return self.bottom

    def left_out(self, edges: Any, names: Any, k: float, sigma: complex) -> dict[int, Any]:
        """Return {index of a condition: what it lacks} where a fluid is cut, at growth rate sigma.

        Raises nothing; `k` in 1/L, sigma in V/L. An example is `stability/flows/shear.py`.
        """
        return {}

    def shortest(self) -> float:
        """Return a wavenumber beyond which no mode grows, as is known without solving anything; inf if none is."""
        return inf

    def bound(self, k: float, sigma: Any) -> Any:
        """Return which growth rates sigma (modes,) are those of modes that fall off where the fluid is cut.

        The others may belong to the continuous spectrum of an unbounded fluid, which a cut makes discrete.

        Raises nothing; `k` in 1/L, sigma in V/L.
        """
        return abs(sigma) >= 0

    @classmethod
    def has_surface_mode(cls) -> bool:
        """Whether there is a slow surface mode to follow from k -> 0."""
        return cls.long_wave is not Flow.long_wave


def check_class(cls: Any, asked: str | None = None) -> Any:
    """Return the class, or raise a ParameterError where it is no class of flows or lacks something."""
    label = f"{asked}: " if asked else ""
    if not (isinstance(cls, type) and issubclass(cls, Flow)):
        raise ParameterError(f"{label}{getattr(cls, '__name__', shown(cls))} is no flow: derive the class from "
                             "stability.flows.Flow")
    for name in ("layers", "conditions"):
        if getattr(cls, name, None) is None:
            raise ParameterError(f"{label}{cls.__name__} has no {name}: define {name}(self, "
                                 f"{'edges, names' if name == 'conditions' else 'names'})")
    if not isinstance(getattr(cls, "name", None), str | property):
        raise ParameterError(f'{label}{cls.__name__} has no name: add name: ClassVar[str] = "{cls.__name__.lower()}"')
    declared = {name for one in cls.__mro__ for name, value in vars(one).items() if isinstance(value, Field)}
    known = {item.name for item in fields(cls)}
    if declared - known or "__dataclass_fields__" not in vars(cls) and _own_parameters(cls):
        raise ParameterError(f"{label}{cls.__name__}: write @dataclass(frozen=True) above the class")
    return cls


def _own_parameters(cls: type) -> list[str]:
    return [name for name, kind in vars(cls).get("__annotations__", {}).items() if "ClassVar" not in str(kind)]


def check_flow(flow: Any) -> Any:
    """Return the flow, or raise a ParameterError where it is something else or its base flow contradicts itself."""
    if not isinstance(flow, Flow):
        hint = f"; did you mean {flow.__name__}()?" if isinstance(flow, type) and issubclass(flow, Flow) else ""
        raise ParameterError(f"flow must be an object of a class in stability.flows{hint} (got {shown(flow)})")
    if not sources.shipped(type(flow)):
        verify(flow)
    return flow


def check_parameter_name(flow: Flow, name: str) -> str:
    """Return `name` if it is a numeric parameter of the flow, else raise a ParameterError."""
    return check_varied(flow.name, fields(flow), name)


def span_of(flow: Any, vary: Any) -> Any:
    """The range of a parameter that is searched unless told otherwise: what the flow says, or around its default."""
    (item,) = (item for item in fields(flow) if item.name == vary)
    rule = item.metadata
    if rule["look"]:
        return rule["look"]
    low, high = rule["low"], rule["high"]
    if low is not None and high is not None:
        return low + _INSET * (high - low), high - _INSET * (high - low)
    default: Any = item.default
    middle = abs(default) if default and not isinf(default) else 1.0
    return middle / _AROUND, middle * _AROUND
