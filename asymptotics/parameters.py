"""Parameters of a flow: name, allowed range and the reason for it."""

from dataclasses import dataclass
from typing import Any

import sympy as sp

from .errors import BadParameter


@dataclass(frozen=True)
class Parameter:
    """A real parameter with lowest < value < highest (or >= lowest where `closed`).

    remedy   what to do about a value out of range
    """

    name: str
    meaning: str
    lowest: sp.Expr
    highest: sp.Expr = sp.oo
    closed: bool = False
    infinite: bool = False
    remedy: str = ""

    @property
    def symbol(self) -> sp.Symbol:
        return sp.Symbol(self.name, positive=True)

    @property
    def flag(self) -> str:
        return "--" + self.name.replace("_", "-")

    @property
    def range(self) -> str:
        left = ">= " if self.closed else "> "
        upper = "" if self.highest == sp.oo else f" and < {self.highest}"
        return f"{left}{self.lowest}{upper}" + (", or inf" if self.infinite else "")

    def read(self, text: Any) -> sp.Expr:
        """An exact number from a string or a number, checked against the range."""
        if str(text).strip().lower() in ("inf", "infinity", "oo"):
            value = sp.oo
        else:
            try:
                value = sp.Rational(str(text).strip())
            except (TypeError, ValueError, ZeroDivisionError):
                raise BadParameter(f"{self.name} must be a number {self.range}, got {text!r}; "
                                   f"write it like {self.flag} {self.example}") from None
        inside = value >= self.lowest if self.closed else value > self.lowest
        if not inside or (value >= self.highest and not (value == sp.oo and self.infinite)):
            raise BadParameter(f"{self.name} must be {self.range}, got {text}: {self.remedy or self.meaning}")
        return value

    @property
    def example(self) -> str:
        upper = self.lowest + 2 if self.highest == sp.oo else self.highest
        return str((self.lowest + upper) / 2)
