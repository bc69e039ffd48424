"""What the status of a result may begin and end with, and what follows from it."""

RESOLVED = "resolved"
STABLE = "stable"  # known not to grow: there is no number, and none is missing
NO_DERIVATIVE = "no derivative"  # with respect to an infinite parameter
INTERRUPTED = "interrupted"  # what a sweep had not reached when it was stopped

_OUTGROWN = "; outgrown"  # another mode grows faster
_INSIDE = "; inside"  # an unstable range


def is_resolved(status: str) -> bool:
    """Whether the numbers beside this status are a result."""
    return status.startswith(RESOLVED)


def is_stable(status: str) -> bool:
    """Whether there is no number because nothing grows."""
    return status.startswith(STABLE)


def is_settled(status: str) -> bool:
    """Whether the question is answered, with a number or without."""
    return status.startswith((RESOLVED, STABLE, NO_DERIVATIVE))


def is_outgrown(status: str) -> bool:
    """Whether another mode grows faster than the one asked for."""
    return status.endswith(_OUTGROWN)


def outgrown(status: str) -> str:
    """Return the status of a mode that another one outgrows."""
    return status + _OUTGROWN


def inside(status: str) -> str:
    """Return the status of a neutral value at which other waves grow."""
    return status + _INSIDE


def doubtful(why: str) -> str:
    """Return the status of a listed mode where others may be missing."""
    return f"others may be missing: {why}"
