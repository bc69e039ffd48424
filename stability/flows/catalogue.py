"""Where flows come from: those of this package, of installed packages, of a running Python, or of one's own file."""

import sys
from collections.abc import Iterator, MutableMapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import ParameterError
from . import sources

if TYPE_CHECKING:
    from .base import Flow

GROUP = "stability.flows"  # of the entry points by which installed packages offer flows
_ELSEWHERE = "a flow of your own is named path/to/file.py:Class or package.module:Class"


class Catalogue(MutableMapping):
    """Classes of flows by name; those of this package are imported when they are asked for.

    `FLOWS` is the one there is; each class states its scales. Raises KeyError for a name it has not, `find` a
    ParameterError.

    >>> "dune" in FLOWS, FLOWS["film"].__name__
    (True, 'Film')
    """

    def __init__(self, shipped: dict[str, str]) -> None:
        self._known: dict[str, str | type[Flow]] = dict(shipped)

    def __getitem__(self, name: str) -> "type[Flow]":
        found = self._known[name]
        if isinstance(found, str):
            module, _, cls = found.partition(":")
            found = self._known[name] = getattr(import_module(f".{module}", __package__), cls)
        return found

    def __setitem__(self, name: str, flow: "type[Flow]") -> None:
        self._known[name] = flow

    def __delitem__(self, name: str) -> None:
        del self._known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._known)

    def __len__(self) -> int:
        return len(self._known)

    def is_shipped(self, name: str) -> bool:
        """Whether the name, one of these, stands for a flow of this package; imports nothing."""
        found = self._known[name]
        return isinstance(found, str) or found.__module__.startswith(f"{__package__}.")


FLOWS = Catalogue({
    "vortex": "vortex:Vortex", "dune": "dune:Dune", "rollwave": "rollwave:RollWave", "film": "film:Film",
    "two_layer_couette": "two_layer_couette:TwoLayerCouette", "poiseuille": "poiseuille:Poiseuille",
    "couette": "couette:Couette", "plane_shear": "steady:PlaneShear", "plate": "steady:Plate",
    "chute": "chute:Chute", "pile": "steady:Pile", "annulus": "annulus:Annulus",
    "shear": "shear:Shear",
})


def register(flow: "type[Flow]") -> "type[Flow]":
    """Make a class of flows known by its `name` in this Python; may be used as a decorator. Returns the class.

    Raises ParameterError where the class breaks its contract, or where the name belongs to another class.

    Scales and units are those that the class states.

    >>> from stability.flows import Couette
    >>> register(Couette) is Couette  # known already, under the same name
    True
    """
    from .base import check_class

    check_class(flow)
    if flow.name in FLOWS and FLOWS[flow.name] is not flow:
        raise ParameterError(f"register: the name {flow.name!r} belongs to {FLOWS[flow.name].__name__}; "
                             f"give {flow.__name__} another one")
    FLOWS[flow.name] = flow
    return flow


def find(name: str) -> "type[Flow]":
    """Return the class of flows that a name stands for: of `FLOWS`, of an installed package, or FILE.py:CLASS.

    Raises ParameterError where there is none, where its file fails, or where it breaks the contract of a flow.

    >>> find("vortex").title
    'longitudinal vortices in granular flow down an inclined plane'

    Scales and units are those that the class states.
    """
    if name in FLOWS:
        return FLOWS[name]
    if ":" in name or name.endswith(".py"):
        found = sources.load_class(name)
    else:
        offered = offers()
        if name not in offered:
            known = [*FLOWS, *offered]
            raise ParameterError(f"unknown flow {name!r}{nearest(name, known)}; flows: {', '.join(known)}; "
                                 f"{_ELSEWHERE}")
        found = sources.from_module(offered[name], f"entry point {name}")
    from .base import check_class

    return check_class(found, name)


def offers() -> dict[str, str]:
    """The flows of installed packages, {name: "package.module:Class"}; names of this package's own come first."""
    if not any(map(_may_offer, sys.path)):
        return {}
    from importlib.metadata import entry_points  # slow to import

    return {one.name: one.value for one in entry_points(group=GROUP) if one.name not in FLOWS}


def _may_offer(place: str) -> bool:
    """Whether packages that are installed in this place of the path may offer flows: a look that costs little."""
    folder = Path(place)
    if not folder.is_dir():
        return folder.exists()  # an archive
    files = (file for kind in ("dist", "egg") for file in folder.glob(f"*.{kind}-info/entry_points.txt"))
    return any(f"[{GROUP}]" in file.read_text(encoding="utf-8", errors="replace") for file in files)


def nearest(name: str, known: Any) -> str:
    """A hint at the name that is meant, or nothing."""
    from difflib import get_close_matches  # slow to import

    match = get_close_matches(name, list(known), 1)
    return f" (did you mean {match[0]!r}?)" if match else ""
