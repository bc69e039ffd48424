"""What is wrong with what was asked, told in one line."""


class BadParameter(ValueError):
    """A parameter outside its range."""


class NoSuchFlow(LookupError):
    """The name is not a flow, or not a regime of it."""


class TooFewPoints(ValueError):
    """Not enough points where the difference exceeds the error of the numerics."""
