"""What can go wrong, by name. Messages say what was asked, what was found and what to try."""


class StabilityError(Exception):
    """Base of all errors of this package."""


class ParameterError(StabilityError, ValueError):
    """A parameter lies outside its range."""


class ConditionCount(StabilityError):
    """The conditions of a flow do not match the order of its layers."""


class NotResolved(StabilityError):
    """The tolerance is not met at the largest degree allowed."""


class ModeLost(StabilityError):
    """A mode could not be followed without risking a jump to another one."""


class StepsExhausted(ModeLost):
    """A mode changes so fast with k that following it takes too many steps."""


class WorkersLost(StabilityError):
    """Worker processes end again and again before they have finished anything."""


def naming(flow, reason):
    """Return the reason with the flow named in front, once."""
    return reason if reason.startswith(f"{flow}: ") else f"{flow}: {reason}"
