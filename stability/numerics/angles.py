"""Tangent and cotangent of an angle in degrees, far beyond double precision.

A friction coefficient tan(slope) close to another one, or an angle close to 90 degrees, would lose all its digits in
the rounding of the angle: differences of such fractions do not.
"""

from fractions import Fraction
from typing import Any

_BITS = 256
_PI = 0x3243F6A8885A308D313198A2E03707344A4093822299F31D0082EFA98EC4E6C89  # pi in units of 2^-256


def tan_deg(degrees: float) -> Any:
    """tan of 0 < degrees < 90, taken exactly, as a fraction with a relative error below 1e-50."""
    return Fraction(*_sine_and_cosine(degrees))


def cot_deg(degrees: float) -> Any:
    """cot of 0 < degrees < 180, taken exactly, as a fraction with an error below 1e-50 (1 + |cot|)."""
    sine, cosine = _sine_and_cosine(degrees)
    return Fraction(cosine, sine)


def _sine_and_cosine(degrees: float) -> tuple[int, ...]:
    """In units of 2^-256."""
    x = int(Fraction(degrees) * _PI / 180)
    sine, cosine, term, n = 0, 0, 1 << _BITS, 0
    while term:
        sign = -1 if n % 4 > 1 else 1
        sine, cosine = (sine + sign * term, cosine) if n % 2 else (sine, cosine + sign * term)
        n += 1
        term = (term * x >> _BITS) // n
    return sine, cosine
