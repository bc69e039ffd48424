"""A progress bar with the time that remains, on a terminal."""

import shutil
import sys
from time import monotonic
from typing import Any

_PAUSE = 0.1  # seconds between two drawings


class Bar:
    """Call with (done, total): draws on standard error if that is a terminal, and clears itself at the end."""

    def __init__(self, quiet: bool = False) -> None:
        self.shown = not quiet and sys.stderr.isatty()
        self.done = self.total = self._first = 0
        self._began: float | None = None
        self._drawn = -_PAUSE

    def __call__(self, done: int, total: int) -> None:
        now = monotonic()
        if self._began is None:
            self._began, self._first = now, done
        self.done, self.total = done, total
        if self.shown and now - self._drawn >= _PAUSE and done < total:
            self._drawn = now
            print("\r" + bar(done, total, self._remaining(now), _width()), end="", file=sys.stderr, flush=True)

    def clear(self) -> None:
        if self.shown and self._drawn > 0:
            print("\r\033[K", end="", file=sys.stderr, flush=True)

    def _remaining(self, now: Any) -> Any:
        """Seconds left at the pace so far, None before there is one; what an earlier run did sets no pace."""
        fresh = self.done - self._first
        return (now - self._began) / fresh * (self.total - self.done) if fresh else None


def bar(done: Any, total: Any, seconds: Any, width: Any) -> Any:
    """The bar as text of a given width."""
    left = "" if seconds is None else f", {_clock(seconds)} left"
    text = f" {done}/{total}, {100 * done // total} %{left}"
    room = width - len(text) - 2
    filled = room * done // total
    return f"[{'#' * filled}{'.' * (room - filled)}]{text}" if room >= 5 else text.strip()[:width]


def _clock(seconds: Any) -> Any:
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02}" if hours else f"{minutes}:{seconds:02}"


def _width() -> Any:
    return min(shutil.get_terminal_size().columns, 80) - 1
