"""Numbers written by `stability dispersion ... --csv`, read from a file or from standard input."""

import sys
from typing import Any

from .usage import BadUsage

_REMEDY = "give the output of stability dispersion ... --csv"
_MARK = "\ufeff"  # of the byte order, which some programs write first


def source(name: str) -> str:
    return "standard input" if name == "-" else name


def read_csv(name: str) -> Any:
    """Header {key: text} from `# key: value` lines, columns {name: array (rows,)}, and what has been left out."""
    import csv

    lines = [line for line in _read(name).removeprefix(_MARK).splitlines() if line.strip()]
    comments = [line[1:].partition(":") for line in lines if line.startswith("#")]
    header = {key.strip(): value.strip() for key, _, value in comments}
    names, *rows = [[cell.strip() for cell in row] for row in csv.reader(
        (line for line in lines if not line.startswith("#")), skipinitialspace=True)] or [[]]
    if absent := [column for column in ("k", "growth_rate") if column not in names]:
        empty = "" if names else "is empty: it "
        raise BadUsage(f"{source(name)} {empty}has no column {', '.join(absent)}; {_REMEDY}")
    return header, *_columns(name, names, [dict(zip(names, row, strict=False)) for row in rows])


def _read(name: str) -> str:
    if name == "-" and sys.stdin is None:
        raise BadUsage("cannot read standard input: it is closed; give the name of a file")
    try:
        with (open(name, encoding="utf-8", newline="") if name != "-" else _keep_open(sys.stdin)) as stream:
            return stream.read()
    except (OSError, ValueError) as reason:
        why = getattr(reason, "strerror", None) or ("not text" if isinstance(reason, UnicodeError) else "no such name")
        raise BadUsage(f"cannot read {source(name)}: {why}; give a file written by stability dispersion ... --csv"
                       ) from None


def _columns(name: str, names: Any, rows: Any) -> Any:
    """Numbers of the resolved rows; the phase speed where there is one, the error 0 where there is none."""
    import numpy as np

    from .limits import FEWEST

    resolved = [row for row in rows if row.get("status", "resolved").startswith("resolved")]
    wanted = [column for column in ("k", "growth_rate", "phase_speed") if column in names]
    if "phase_speed" not in names and len(resolved) < FEWEST:
        raise BadUsage(f"{source(name)} has no column phase_speed, and of growth rates alone {FEWEST} are needed "
                       f"(got {len(resolved)} resolved); {_REMEDY}")
    try:
        columns = {column: np.array([float(row[column]) for row in resolved]) for column in wanted}
        columns["error"] = np.array([abs(float(row.get("error") or 0)) for row in resolved])
    except (KeyError, ValueError):
        raise BadUsage(f"{source(name)}: a row is not numbers; {_REMEDY}") from None
    if not (columns["k"] > 0).any() or (columns["k"] <= 0).any():
        raise BadUsage(f"{source(name)} has no resolved row with k > 0, or one with another k; give at least four "
                       "small wavenumbers")
    others = [row["k"] for row in rows if row not in resolved]
    return columns, [f"{len(others)} of {len(rows)} rows left out: not resolved, first at k = {k}" for k in others[:1]]


class _keep_open:
    """A stream that its `with` block does not close."""

    def __init__(self, stream: Any) -> None:
        self.stream = stream

    def __enter__(self) -> Any:
        return self.stream

    def __exit__(self, *_: Any) -> None:
        return None
