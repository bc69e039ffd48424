"""A journal of finished pieces of work: one JSON line each, so that a run that ends early loses nothing."""

import json
import os
from contextlib import suppress
from pathlib import Path

try:
    import fcntl
except ImportError:  # no such lock on this system
    fcntl = None  # type: ignore[assignment]

from .errors import ParameterError


class Journal:
    """Append-only file of the pieces of one request; `done` maps the index of each to its rows.

    The first line is the request, a dict. A last line torn by a kill is dropped. Raises ParameterError where the
    file belongs to another request, is in use by another run, or cannot be written.
    """

    def __init__(self, path, request):
        self.path = Path(path)
        self.done = {}
        try:
            self._file = open(self.path, "a+b", buffering=0)  # noqa: SIM115 - closed by __exit__
        except OSError as reason:
            raise self._unwritable(reason) from None
        try:
            self._lock()
            self._size = self._read(request)
            self._file.truncate(self._size)
            if not self._size:
                self._append(json.dumps(request).encode() + b"\n")
        except BaseException:
            self._file.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *failure):
        self._file.close()

    def add(self, index, rows):
        """Keep the rows of a piece: they are with the operating system when this returns."""
        self._append(json.dumps([index, rows]).encode() + b"\n")
        self.done[index] = rows

    def _append(self, line):
        rest = memoryview(line)
        try:
            while rest:
                rest = rest[self._file.write(rest):]
        except OSError as reason:
            with suppress(OSError):
                self._file.truncate(self._size)
            raise self._unwritable(reason) from None
        self._size += len(line)

    def _read(self, request):
        """Fill `done`; return the length of the part that is whole."""
        self._file.seek(0)
        header, ended, lines = self._file.read().partition(b"\n")
        if not ended and json.dumps(request).encode().startswith(header):
            return 0  # new, or ended while its first line was written
        self._check(_entry(header), json.loads(json.dumps(request)))
        size = len(header) + 1
        for line in lines.splitlines(keepends=True):
            entry = _entry(line)
            if entry is None or not line.endswith(b"\n"):
                break
            index, rows = entry
            self.done[index] = rows
            size += len(line)
        return size

    def _check(self, found, request):
        if found == request:
            return
        found = found if isinstance(found, dict) else {}
        parts = [key for key in request if found.get(key) != request[key]]
        raise ParameterError(f"{str(self.path)!r} keeps the unfinished map of another request (differs in "
                             f"{', '.join(parts)}): repeat that one, give another file, or delete it")

    def _lock(self):
        if fcntl is None:
            return
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise ParameterError(f"{str(self.path)!r} is in use: another run is computing this map") from None
        except OSError:  # a file system without locks
            return

    def _unwritable(self, reason):
        kept = "; what is done is kept, the same command resumes" if self.done else ""
        return ParameterError(f"cannot write {str(self.path)!r}: {os.strerror(reason.errno)}{kept}")


def _entry(line):
    """The value of a line, or None where it is torn."""
    try:
        return json.loads(line)
    except ValueError:
        return None
