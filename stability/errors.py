"""What can go wrong, by name. Messages say what was asked, what was found and what to try."""


class StabilityError(Exception):
    """Base of all errors of this package."""


class ParameterError(StabilityError, ValueError):
    """A parameter lies outside its range."""


class NotSmooth(ParameterError):
    """A base flow has a kink, a step or noise, or a value that is not a finite real number.

    `where` names flow and layer, `complaint` the coefficient, `height` is the z where it is rough, or None.
    """

    def __init__(self, where, complaint, height, remedy):
        super().__init__(where, complaint, height, remedy)
        self.where, self.complaint, self.height, self.remedy = where, complaint, height, remedy

    def of(self, flow, bottom):
        """Return the same with the flow named, and the height measured from where z = 0 in it."""
        height = None if self.height is None else self.height + bottom
        return NotSmooth(f"{flow}: {self.where}", self.complaint, height, self.remedy)

    def __str__(self):
        place = "" if self.height is None else f" near z = {self.height:.4g}"
        return f"{self.where}: {self.complaint}{place}: {self.remedy}"


class ConditionCount(ParameterError):
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
