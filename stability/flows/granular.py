"""Granular scenes under any friction law: the parameters of the law are parameters of the flow.

`Dune(shields=1.4, law=Saturating(mu1=0.4, mu2=0.6, I0=0.3))` is an object of a class derived from Dune, whose fields
are those of the scene and, in place of mu1 and b, those of the law: they sweep, vary and have sensitivities like all
others. `Dune.under(Saturating)` is this class.
"""

from dataclasses import Field, field, fields, make_dataclass
from functools import lru_cache
from typing import Any, ClassVar

from ..checks import shown
from ..errors import ParameterError, naming
from . import sources
from .base import Flow
from .contract import OPTIONS
from .law import Law, check_law
from .laws import Linear


class _Scene(type):
    """Classes that take a `law`."""

    def __call__(cls, *values: Any, law: Law | None = None, **named: Any) -> Any:
        if law is None:
            return super().__call__(*values, **named)
        return type.__call__(_with_law(cls, law, values, named), **named)


def _with_law(cls: Any, law: Any, values: Any, named: Any) -> Any:
    """The class for a scene under a law; its parameters are added to `named`."""
    if not isinstance(law, Law):
        hint = f"; did you mean {law.__name__}()?" if isinstance(law, type) and issubclass(law, Law) else ""
        raise ParameterError(f"{cls.name}: law must be a friction law, such as Linear(mu1=0.4, b=1){hint} "
                             f"(got {shown(law)})")
    flat = cls.under(type(law))
    own = [item.name for item in fields(flat) if item.name not in law.values]
    twice = [name for name in named if name in law.values or name in cls.lawful()]
    if twice:
        raise ParameterError(f"{cls.name}: {twice[0]} belongs to the friction law: give it there, "
                             f"law={type(law).__name__}(...)")
    if len(values) > len(own):
        raise ParameterError(f"{cls.name}: takes at most {len(own)} parameters besides law, {', '.join(own)} "
                             f"(got {len(values)})")
    for name, value in zip(own, values, strict=False):
        if name in named:
            raise ParameterError(f"{cls.name}: {name} given twice")
        named[name] = value
    named.update(law.values)
    return flat


class Granular(Flow, metaclass=_Scene):
    """A flow of grains. `friction` is the class of its usual law, of whose parameters `unit` fixes some."""

    friction: ClassVar[type[Law]] = Linear
    unit: ClassVar[dict[str, float]] = {}

    def __post_init__(self) -> None:
        super().__post_init__()
        try:
            _ = self.law
        except ParameterError as reason:
            raise ParameterError(naming(self.name, str(reason))) from None

    def __reduce__(self) -> Any:
        if "scene" not in vars(type(self)):
            return super().__reduce__()
        law = self.law
        own = {name: value for name, value in self._values().items() if name not in law.values}
        return _revived, (sources.ticket(self.scene), law, own)  # type: ignore[attr-defined]

    def __repr__(self) -> str:
        law, values = self.law, self._values()
        own = [f"{name}={value!r}" for name, value in values.items() if name not in law.values]
        return f"{type(self).__name__}({', '.join([*own[:1], f'law={law!r}', *own[1:]])})"

    def _values(self) -> dict[str, Any]:
        return {item.name: getattr(self, item.name) for item in fields(self)}

    def stated(self) -> dict[str, Any]:
        """The parameters, with the law in front where it is not the usual one, and where one's own comes from."""
        law = self.law
        if "scene" not in vars(type(self)):
            return super().stated()
        where = {f"law_{key}": value for key, value in sources.origin(type(law)).items()}
        return {"law": law.name, **where, **super().stated()}

    @property
    def law(self) -> Law:
        """The friction law."""
        kind: Any = self.friction
        return _law(kind, tuple(self.unit.get(item.name, getattr(self, item.name, None)) for item in fields(kind)))

    def with_law(self, law: Law) -> "Granular":
        """Return the flow with another friction law and its other parameters."""
        cls = vars(type(self)).get("scene", type(self))
        kept = {item.name for item in fields(cls.under(type(law)))} - set(law.values)
        return cls(law=law, **{name: value for name, value in self._values().items()
                               if name in kept and name not in self.law.values})

    @classmethod
    def lawful(cls) -> tuple[str, ...]:
        """Names of the parameters that belong to the law."""
        return tuple(item.name for item in fields(cls.friction) if item.name not in cls.unit)

    @classmethod
    def under(cls, law: type[Law]) -> "type[Granular]":
        """Return the class of these flows under a class of laws.

        >>> from stability.flows import Dune, Saturating
        >>> Dune.under(Saturating)(shields=1.4).law
        Saturating(mu1=0.4, mu2=0.6434683848584607, I0=0.279)
        """
        scene = vars(cls).get("scene", cls)
        if law is scene.friction and not scene.unit:
            return scene
        return _under(scene, check_law(law, getattr(law, "name", "law")))  # type: ignore[arg-type]

    @classmethod
    def extras(cls, law: type[Law]) -> dict[str, Any]:
        """Further parameters that the scene has under a law, {name: parameter(...)}."""
        return {}


@lru_cache(maxsize=256)
def _under(scene: Any, law: Any) -> Any:
    usual = {item.name: item for item in fields(scene)}
    names = [item.name for item in fields(law)]
    replaced = scene.lawful()
    for name in names:
        clash = "a parameter" if name in usual and name not in replaced else \
            "an attribute" if name not in usual and hasattr(scene, name) else \
            "an option of the command line" if name in OPTIONS else ""
        if clash:
            raise ParameterError(f"{scene.name}: law {law.name}: rename its parameter {name}: that is {clash} of "
                                 f"{scene.name}")
    added = {item.name: _declared(usual.get(item.name), item) for item in fields(law)} | scene.extras(law)
    gone = {name: None for name in replaced if name not in names}
    columns: list[Any] = [(name, float, declared) for name, declared in added.items()]
    columns += [(name, ClassVar[None], None) for name in gone]
    namespace = {"__module__": scene.__module__, "__qualname__": scene.__qualname__, "__doc__": scene.__doc__,
                 "__repr__": Granular.__repr__, "scene": scene, "friction": law, "unit": {}}
    return make_dataclass(scene.__name__, columns, bases=(scene,), namespace=namespace, frozen=True, repr=False)


@lru_cache(maxsize=256)
def _law(friction: Any, values: tuple[float, ...]) -> Law:
    return friction(*values)


def _declared(usual: Any, item: Any) -> Any:
    """The parameter of a law, with the default that the scene has for it."""
    source: Field = usual or item
    look = {"look": usual.metadata["look"]} if usual else {}
    return field(default=source.default, metadata={**item.metadata, **look})


def _revived(ticket: Any, law: Any, own: Any) -> Any:
    return sources.revive(ticket, {"law": law, **own})
