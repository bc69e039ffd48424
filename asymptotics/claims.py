"""What is known beforehand of the difference between numerics and a series: the powers to expect."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .comparison import PART_NAMES
from .series import vanishes

if TYPE_CHECKING:
    from .series import Expansion


@dataclass(frozen=True)
class Claim:
    """What is known of the difference, by part where a dict.

    parts   the powers to expect
    below   lower ones that show where a coefficient is wrong
    """

    expected: float
    parts: dict[str, float]
    below: dict[str, list[float]]
    step: float
    coefficients: dict[str, dict[float, float]]
    correction: float | None
    towards: int = 1


def claim_of(series: Any, expected: int | None) -> Claim:
    if hasattr(series, "next_power"):
        return _claim_of_expansion(series, expected)
    if expected is None:
        raise TypeError("expected must be given unless the series is an Expansion")
    power = float(expected)
    below = np.arange(max(0.0, np.ceil(power))).tolist()
    return Claim(power, dict.fromkeys(PART_NAMES, power), dict.fromkeys(PART_NAMES, below), 1.0,
                  dict.fromkeys(PART_NAMES, {}), None, -1 if power < 0 else 1)


def _claim_of_expansion(law: "Expansion", expected: Any) -> Claim:
    values = law.values()
    following = law.next_powers if expected is None else dict.fromkeys(PART_NAMES, float(expected))
    spacing = float(law.spacing)
    first = float(law.next_power if expected is None else expected)
    towards = 1 if first > float(max(values)) else -1
    coefficients = {name: {float(power): getattr(c, name) for power, c in values.items() if not vanishes(c, name)}
                    for name in PART_NAMES}
    below = {name: [float(power) for power in values if _has(law, name, power)] for name in PART_NAMES}
    step = 2 * spacing if law.alternates and spacing == 1 else spacing
    return Claim(first, {name: float(power) for name, power in following.items()}, below, step, coefficients,
                  spacing if towards > 0 else None, towards)


def _has(law: "Expansion", part: str, power: Any) -> bool:
    """Whether a power can occur in a part."""
    return not law.alternates or power % 2 == (part == "imag")
