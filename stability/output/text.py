"""Results as a table, CSV or JSON, on standard output or in a file that is written whole or not at all."""

import csv
import io
import json
import os
import tempfile
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from math import isinf
from pathlib import Path
from stat import S_ISDIR
from typing import Any

from .. import __version__
from ..checks import check_file_name
from ..errors import ParameterError
from ..flows.sources import origin
from ..status import RESOLVED

Row = dict[str, Any]
_LAYOUTS = ((10, 2), (8, 2), (6, 2), (6, 1), (4, 1))  # digits and spaces between columns of a table, widest first
_ROUGH = "error", "reported", "seconds", "condition"  # endings of the columns that take two digits
_FIRST = ("flow", "method", "version")  # comments above CSV
_LABELS = 2  # columns that every block of a split table begins with
_FEW_DIGITS = 4  # digits at which lists give way to their length
_PREFIX = 100  # bytes of a file's name that its temporary file shows


def header_of(flow: Any, method: str, about: dict[str, Any], notes: Sequence[str] = (),
              swept: Collection[str | None] = ()) -> dict[str, Any]:
    """What belongs to a whole result: flow, parameters but the swept ones, method, version, `about`, notes if any."""
    parameters = {name: value for name, value in flow.stated().items() if name not in swept}
    header = {"flow": flow.name, "parameters": parameters, "method": method, "version": __version__,
              **origin(type(flow)), **about}
    return {**header, "notes": list(notes)} if notes else header


def measured(flow: Any, *names: str) -> tuple[str, ...]:
    """Names of the columns that a flow with measured data has beside its error bars: `data_error`, and others."""
    return () if flow.data is None else ("data_error", *names)


def render(form: str, header: dict[str, Any], rows: list[Row], width: int | None = None) -> str:
    """Return rows (dicts with the same keys) as text in the form "table", "csv" or "json".

    `header` is that of `header_of`, and whatever else belongs to the whole result; `width` is for `table`.
    """
    if form == "json":
        return json.dumps(_json_value({**header, "rows": rows}), indent=1, allow_nan=False) + "\n"
    if form == "csv":
        return _csv(header, rows)
    return table(rows, width)


def _json_value(value: Any) -> Any:
    """JSON has no infinity: write it as the string that the command line takes."""
    if isinstance(value, dict):
        return {key: _json_value(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_json_value(item) for item in value]
    return str(value) if isinstance(value, float) and isinf(value) else value


def _csv(header: dict[str, Any], rows: list[Any]) -> str:
    text = io.StringIO()
    for key in _FIRST:
        text.write(f"# {key}: {header[key]}\n")
    others = {key: value for key, value in header.items() if key not in (*_FIRST, "parameters", "notes")}
    for key, value in {**header["parameters"], **others}.items():
        text.write(f"# {key}: {value}\n")
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({key: json.dumps(_json_value(value)) if isinstance(value, list) else value
                         for key, value in row.items()})
    return text.getvalue()


def table(rows: list[Row], width: int | None = None) -> str:
    """Return rows as a table with aligned columns; at least one row.

    Where it is wider than `width`, digits, spaces and lists give way, and if that is not enough it is split into
    blocks of columns; a long status may still stand out.
    """
    for layout in _LAYOUTS:
        text = _table(rows, *layout)
        if width is None or _width(rows, text) <= width:
            return text
    return "\n".join(_table(part, *_LAYOUTS[-1]) for part in _blocks(rows, width))


def _width(rows: Any, text: Any) -> Any:
    """Length of the longest line of a table; of a long status the length of a short one."""
    return max(len(line) - max(len(str(row.get("status", ""))) - len(RESOLVED), 0)
               for line, row in zip(text.splitlines(), (rows[0], *rows), strict=True))


def _blocks(rows: Any, width: Any) -> Iterator[Any]:
    """Yield the rows with as many of their columns as fit, each time after the first ones."""
    names = list(rows[0])
    labels, rest = names[:_LABELS], names[_LABELS:]
    while rest:
        count = len(rest)
        while True:
            part = [{name: row[name] for name in labels + rest[:count]} for row in rows]
            if count == 1 or _width(part, _table(part, *_LAYOUTS[-1])) <= width:
                break
            count -= 1
        yield part
        rest = rest[count:]


def _table(rows: list[Any], digits: int, gap: int) -> str:
    cells = [[_cell(key, value, digits) for key, value in row.items()] for row in rows]
    columns = list(zip(list(rows[0]), *cells, strict=True))
    widths = [max(len(cell) for cell in column) for column in columns]
    texts = [isinstance(value, str) for value in rows[0].values()]
    lines = zip(*([cell.ljust(width) if text else cell.rjust(width) for cell in column]
                  for column, width, text in zip(columns, widths, texts, strict=True)), strict=True)
    return "".join((" " * gap).join(line).rstrip() + "\n" for line in lines)


def html_table(title: str, rows: list[Row], gap: int | None = None) -> str:
    """Return rows as a table in HTML, with a row of dots after the first `gap` ones if some are left out there."""
    from html import escape  # slow to import

    digits = _LAYOUTS[0][0]
    lines = ["".join(f"<td>{escape(_cell(key, value, digits))}</td>" for key, value in row.items()) for row in rows]
    if gap is not None:
        lines.insert(gap, f'<td colspan="{len(rows[0])}">...</td>')
    head = "".join(f"<th>{escape(name)}</th>" for name in rows[0]) if rows else ""
    body = "".join(f"<tr>{line}</tr>\n" for line in (head, *lines))
    return f"<table>\n<caption>{escape(title)}</caption>\n{body}</table>"


def _cell(key: str, value: Any, digits: int) -> str:
    if value is None:
        return "-"
    if isinstance(value, list) and digits <= _FEW_DIGITS:
        return str(len(value))
    if isinstance(value, list):
        return " ".join(f"({k:.6g}, {growth:.4g})" for k, growth in value) or "-"
    if isinstance(value, float):
        return f"{value:.1e}" if key.endswith(_ROUGH) else f"{value:.{digits}g}"
    return str(value)


@contextmanager
def whole_file(path: str | os.PathLike[str], name: str) -> Iterator[Path]:
    """Yield a temporary path beside `path` that replaces it when the block ends well.

    Raises ParameterError, naming the option or method `name`, where the file cannot be written.
    """
    target = _path(path, name)
    temporary = target if _is_stream(target) else _temporary(target, name)
    try:
        yield temporary
        if temporary is target:
            return
        _check_target(target, name)
        os.chmod(temporary, 0o666 & ~_umask())
        os.replace(temporary, os.path.realpath(target))
    except OSError as reason:
        raise ParameterError(f"{name}: cannot write {str(target)!r}: {reason.strerror}") from None
    finally:
        if temporary is not target:
            temporary.unlink(missing_ok=True)


def check_writable(path: str | os.PathLike[str], name: str) -> None:
    """Raise the error that `whole_file` would raise, before the work is done."""
    target = _path(path, name)
    if _is_stream(target):
        return
    _temporary(target, name).unlink()
    _check_target(target, name)


def _check_target(path: Any, name: str) -> None:
    """Raise the error that replacing `path` would raise."""
    try:
        why = "it is a directory" if S_ISDIR(os.stat(path).st_mode) else ""
    except OSError as reason:
        why = "" if isinstance(reason, FileNotFoundError) else str(reason.strerror)
    if why:
        raise ParameterError(f"{name}: cannot write {str(path)!r}: {why}")


def _path(path: Any, name: Any) -> Any:
    return Path(check_file_name(path, f"{name}: path"))


def _is_stream(path: Any) -> bool:
    """Whether the path is a device or a pipe: written to directly, and never replaced."""
    return os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path)


def _temporary(path: Any, name: str) -> Any:
    """An empty file beside the target of `path`, with the beginning of its name and its ending."""
    target = Path(os.path.realpath(path))
    start, ending = (os.fsencode(part)[:_PREFIX].decode(errors="ignore") for part in (target.name, path.suffix))
    try:
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{start}.", suffix=ending)
    except OSError as reason:
        raise ParameterError(f"{name}: cannot write {str(path)!r}: {reason.strerror}") from None
    os.close(handle)
    return Path(temporary)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
