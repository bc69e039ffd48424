"""stability explore: a window with the dispersion relation of a flow and a slider for every parameter."""

import argparse
from typing import Any

from ...checks import check_integer
from ...errors import ParameterError
from ..asked import checked, flow_of
from ..common import SPEC, add_bare_verb
from ..specs import read_spec
from ..streams import say

_WAVENUMBERS = "0.01:10:80"
_PORT = 8988
_FILES = "agg", "pdf", "svg", "ps", "cairo", "template", "pgf"  # backends of matplotlib without a window


def add(verbs: Any) -> None:
    add_bare_verb(verbs, "explore", _run, "stability explore dune --web", _options)


def _options(verb: Any) -> None:
    verb.add_argument("--k", metavar="SPEC", default=_WAVENUMBERS,
                      help=f"wavenumbers: {SPEC} (default {_WAVENUMBERS})")
    verb.add_argument("--web", action="store_true", help="in a browser instead of a window (pip install '.[web]')")
    verb.add_argument("--port", metavar="N", help=f"of the page of --web (default {_PORT}, or the next that is free)")


def _run(arguments: argparse.Namespace) -> Any:
    checked(arguments)
    k = read_spec(arguments.k, "--k")
    if arguments.port is not None and not arguments.web:
        raise ParameterError("--port: belongs to --web; leave it out")
    port = _PORT if arguments.port is None else check_integer(arguments.port, "--port", 1, 65535)
    flow = flow_of(arguments)
    _open(arguments.web, port)
    from matplotlib import pyplot

    from ...studies.explore import explore

    window = explore(flow, k.array, source=arguments.flow)
    if arguments.web and not arguments.quiet:
        say("stability: Ctrl-C ends the page")
    pyplot.show(block=True)
    del window
    return 0


def _open(web: Any, port: Any) -> None:
    """Choose where figures appear; ParameterError, in one line, where they cannot."""
    import matplotlib

    if web:
        try:
            import tornado  # noqa: F401
        except ModuleNotFoundError:
            raise ParameterError("--web: needs the server tornado: pip install tornado") from None
        matplotlib.rcParams["webagg.port"] = port
        matplotlib.use("webagg")
        return
    try:
        backend = matplotlib.get_backend()  # the first that opens a window here, else one that only writes files
    except ImportError as reason:
        raise ParameterError(f"explore: no window can be opened ({reason}); try: stability explore FLOW --web") \
            from None
    if backend.lower() in _FILES:
        raise ParameterError("explore: there is no display to open a window on; try: stability explore FLOW --web")
