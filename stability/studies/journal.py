"""A journal of finished pieces of work: one JSON line each, so that a run that ends early loses nothing.

A line is ["checksum", content]. The checksum is that of the first line's content and its own, so that a line out of
another journal does not pass; the content of the first line is the request, that of the others an index and rows.
"""

import json
import os
from contextlib import suppress
from hashlib import blake2b
from pathlib import Path
from typing import Any
from weakref import WeakSet

try:
    import fcntl
except ImportError:  # no such lock on this system
    fcntl = None  # type: ignore[assignment]

from ..errors import ParameterError

_open: "WeakSet[Journal]" = WeakSet()
_CHECKSUM = 8  # bytes: damage passes by chance once in 2^64
_DELETE = "give another file, or delete it to compute the map anew"


class Journal:
    """Append-only file of the pieces of one request, a dict; `done` maps the index of each to its rows.

    `shapes` holds (rows, columns) of every piece. A last line torn by a kill is dropped. Lines that are damaged,
    doubled or foreign are left out, and counted in `damaged`: their pieces are not in `done`, unless other lines hold
    them. Raises ParameterError where the file belongs to another request, is no journal or one without checksums, is
    in use by another run, or cannot be written.
    """

    def __init__(self, path: Any, request: dict[str, Any], shapes: list[tuple[Any, ...]] | None = None) -> None:
        self.path = Path(path)
        self.done = {}
        self.damaged = 0
        self._shapes = shapes
        self._request = json.dumps(request).encode()
        try:
            self._file = open(self.path, "a+b", buffering=0)  # noqa: SIM115 - closed by __exit__
        except OSError as reason:
            raise self._unwritable(reason) from None
        try:
            self._lock()
            self._size = self._read()
            self._file.truncate(self._size)
            if not self._size:
                self._append(self._header)
        except BaseException:
            self._file.close()
            raise
        _open.add(self)

    def __enter__(self) -> "Journal":
        return self

    def __exit__(self, *failure: Any) -> None:
        self._file.close()

    def add(self, index: int, rows: list[list[float]]) -> None:
        """Keep the rows of a piece: they are with the operating system when this returns."""
        content = json.dumps([index, rows]).encode()
        self._append(_line(self._request + content, content))
        self.done[index] = rows

    def _append(self, line: bytes) -> None:
        rest = memoryview(line)
        try:
            while rest:
                rest = rest[self._file.write(rest):]
        except OSError as reason:
            with suppress(OSError):
                self._file.truncate(self._size)
            raise self._unwritable(reason) from None
        self._size += len(line)

    @property
    def _header(self) -> bytes:
        return _line(self._request, self._request)

    def _read(self) -> int:
        """Fill `done`; return the length up to the end of the last line that ends."""
        self._file.seek(0)
        found = self._file.read()
        if self._header.startswith(found):
            return 0  # new, or ended while its first line was written
        header, ended, rest = found.partition(b"\n")
        if header + ended != self._header:
            self._refuse(header)
        *lines, torn = rest.split(b"\n")
        for line in lines:
            self._take(line)
        return len(found) - len(torn)

    def _take(self, line: Any) -> None:
        """Add the piece of a line to `done`, or count the line as damaged."""
        content = _content(line)
        whole = line + b"\n" == _line(self._request + content, content)
        match _entry(content) if whole else None:
            case [int() as index, list() as rows] if index not in self.done and self._fits(index, rows):
                self.done[index] = rows
            case _:
                self.damaged += 1

    def _fits(self, index: Any, rows: Any) -> Any:
        if self._shapes is None:
            return True
        if not 0 <= index < len(self._shapes):
            return False
        count, width = self._shapes[index]
        return len(rows) == count and all(isinstance(row, list) and len(row) == width for row in rows)

    def _refuse(self, header: Any) -> None:
        """Say whose the file is, or why that is not known."""
        name, request, content = repr(str(self.path)), json.loads(self._request), _content(header)
        found = _entry(content)
        if isinstance(found, dict) and header + b"\n" == _line(content, content):
            parts = [key for key in request if found.get(key) != request[key]]
            raise ParameterError(f"{name} keeps the unfinished map of another request (differs in "
                                 f"{', '.join(parts)}): repeat that one, give another file, or delete it")
        old = _entry(header)
        if isinstance(old, dict) and request.keys() <= old.keys():
            raise ParameterError(f"{name} keeps a map without checksums, of an earlier version: {_DELETE}")
        raise ParameterError(f"{name} is not the journal of a map, or its first line is damaged: {_DELETE}")

    def _lock(self) -> None:
        if fcntl is None:
            return
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise ParameterError(f"{str(self.path)!r} is in use: another run is computing this map") from None
        except OSError:  # a file system without locks
            return

    def _unwritable(self, reason: Any) -> Any:
        kept = "; what is done is kept, the same command resumes" if self.done else ""
        return ParameterError(f"cannot write {str(self.path)!r}: {os.strerror(reason.errno)}{kept}")


def _let_go() -> None:
    """In a forked process: its copies of the files would keep them locked when their owner is gone."""
    for journal in _open:
        journal._file.close()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_let_go)


def _line(checked: bytes, content: bytes) -> bytes:
    return b'["%s", %s]\n' % (blake2b(checked, digest_size=_CHECKSUM).hexdigest().encode(), content)


def _content(line: Any) -> Any:
    """What a line holds behind its checksum, whole or not."""
    return line[2 * _CHECKSUM + len('["", '):-1]


def _entry(text: Any) -> Any:
    """The value of a text, or None where it is no JSON."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None
