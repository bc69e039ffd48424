"""A sum A - rate B of constant matrices times scalars: what its factors and products take, however it came about."""

from functools import cached_property
from typing import Any

import numpy as np

from ..numerics.bordered import Bordered, Factors, ManyFactors
from ..numerics.stack import Stack


class Combination:
    """Matrices, the parts of A - rate B, whose entries lie where `_where` says and have the values `_value` (entries,).

    `_where` has the places `stack`, `places` and `b` of all entries, of those in the bordered matrix and of those of B,
    and `carriers` (parts,), which parts are of B; the values `_carried` are those of B.
    """

    _where: Any
    _value: Any
    _carried: Any

    @property
    def entries(self) -> int:
        """How many numbers the bordered matrix of one point takes."""
        return self._where.places.count

    @cached_property
    def stack(self) -> Stack:
        return Stack(self._where.stack, self._value)

    @cached_property
    def _bordered(self) -> Bordered:
        return Bordered(self._where.places, self._value)

    @cached_property
    def _b(self) -> Stack:
        return Stack(self._where.b, -self._carried)

    def powers(self, rate: Any) -> np.ndarray:
        """Factor of every part in the residual: 1 in A, the rate in B; (parts,) then the shape of rate."""
        return np.where(self._where.carriers[(...,) + (None,) * np.ndim(rate)], rate, 1.0)

    def factors(self, weights: np.ndarray, rate: Any) -> Any:
        """Return LU factors of A - rate B for weights (parts,) or (parts, points) of the parts, and rates (points,)."""
        if np.ndim(rate) > weights.ndim - 1:
            carriers = self._where.carriers
            return ManyFactors(self._bordered, np.stack((weights * ~carriers, weights * carriers), axis=1), rate)
        kind = ManyFactors if np.ndim(rate) else Factors
        return kind(self._bordered, weights * self.powers(rate))

    def b_products(self, weights: np.ndarray) -> tuple[Any, ...]:
        """Return the functions B x of x and y^T B of y, (size, points) or (size,), for weights (parts, points) or
        (parts,) of the parts."""
        return self._b.summed(weights)
