"""What became of a question: a `Status`, one of a few `Kind`s with a message and asides, whose text is what is printed.

>>> status = unresolved("error 1.0e-02 exceeds tolerance")
>>> status.kind is Kind.UNRESOLVED, status
(True, 'error 1.0e-02 exceeds tolerance')
>>> as_outgrown(RESOLVED), is_resolved(as_outgrown(RESOLVED)), is_outgrown(status_of("resolved; outgrown"))
('resolved; outgrown', True, True)
"""

from enum import Enum


class Kind(Enum):
    """Whether there is an answer; the value begins the text, but for the last one, whose message is all of it."""

    RESOLVED = "resolved"
    STABLE = "stable"  # known not to grow: there is no number, and none is missing
    NO_DERIVATIVE = "no derivative"  # with respect to an infinite parameter
    INTERRUPTED = "interrupted"  # what a sweep had not reached when it was stopped
    LOST = "lost"  # the mode could not be followed so far
    UNRESOLVED = ""


class Aside(Enum):
    """What else is known of an answer; the value ends the text."""

    OUTGROWN = "; outgrown"  # another mode grows faster
    INSIDE = "; inside"  # an unstable range


class Status(str):
    """A text that knows its `kind`, its `message` and its `asides`. It equals the same text."""

    kind: Kind
    message: str
    asides: tuple[Aside, ...]

    def __new__(cls, kind: Kind, message: str = "", asides: tuple[Aside, ...] = ()) -> "Status":
        parts = [part for part in (kind.value, message) if part]
        self = super().__new__(cls, ": ".join(parts) + "".join(aside.value for aside in asides))
        self.kind, self.message, self.asides = kind, message, asides
        return self

    def __getnewargs__(self) -> tuple[Kind, str, tuple[Aside, ...]]:  # type: ignore[override]
        return self.kind, self.message, self.asides

    def but(self, aside: Aside) -> "Status":
        """Return the same with one more aside."""
        return Status(self.kind, self.message, (*self.asides, aside))


RESOLVED, STABLE, INTERRUPTED, LOST = map(Status, (Kind.RESOLVED, Kind.STABLE, Kind.INTERRUPTED, Kind.LOST))


def unresolved(why: object) -> Status:
    """Return the status of what is not known, and why."""
    return Status(Kind.UNRESOLVED, str(why))


def status_of(text: str) -> Status:
    """Return the status that a text says, such as one of a file: the only place that looks into it."""
    if isinstance(text, Status):
        return text
    asides: list[Aside] = []
    while aside := next((one for one in Aside if text.endswith(one.value)), None):
        text, asides = text.removesuffix(aside.value), [aside, *asides]
    for kind in Kind:
        if kind.value and (text == kind.value or text.startswith(f"{kind.value}: ")):
            return Status(kind, text[len(kind.value) + 2:], tuple(asides))
    return Status(Kind.UNRESOLVED, text, tuple(asides))


def is_resolved(status: str) -> bool:
    """Whether the numbers beside this status are a result."""
    return status_of(status).kind is Kind.RESOLVED


def is_stable(status: str) -> bool:
    """Whether there is no number because nothing grows."""
    return status_of(status).kind is Kind.STABLE


def is_settled(status: str) -> bool:
    """Whether the question is answered, with a number or without."""
    return status_of(status).kind in (Kind.RESOLVED, Kind.STABLE, Kind.NO_DERIVATIVE)


def is_interrupted(status: str) -> bool:
    """Whether the question was not reached."""
    return status_of(status).kind is Kind.INTERRUPTED


def is_outgrown(status: str) -> bool:
    """Whether another mode grows faster than the one asked for."""
    return Aside.OUTGROWN in status_of(status).asides


def as_outgrown(status: str) -> Status:
    """Return the status of a mode that another one outgrows."""
    return status_of(status).but(Aside.OUTGROWN)


def as_inside(status: str) -> Status:
    """Return the status of a neutral value at which other waves grow."""
    return status_of(status).but(Aside.INSIDE)


def doubtful(why: str) -> Status:
    """Return the status of a listed mode where others may be missing."""
    return unresolved(f"others may be missing: {why}")
