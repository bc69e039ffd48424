"""What follows from k and sigma, of one eigenvalue and of a collection."""

from typing import Any

import numpy as np

from ..status import Status


class Eigenvalue:
    """Base of what has a wavenumber `k` and a complex growth rate `sigma`."""

    k: float
    sigma: complex

    @property
    def growth_rate(self) -> float:
        """Real part of sigma, V/L: positive where the mode grows."""
        return self.sigma.real

    @property
    def c(self) -> complex:
        """Complex wave speed i sigma / k."""
        return 1j * self.sigma / self.k

    @property
    def phase_speed(self) -> float:
        """Real part of c, V: positive downstream."""
        return self.c.real + 0.0  # no negative zero


class Eigenvalues:
    """Base of what has several of them as `modes`: arrays (modes,) in their order."""

    modes: Any

    @property
    def sigma(self) -> np.ndarray:
        """Complex growth rates."""
        return self._of_each("sigma")

    @property
    def growth_rate(self) -> np.ndarray:
        """Real parts of sigma, V/L."""
        return self.sigma.real

    @property
    def phase_speed(self) -> np.ndarray:
        """Real parts of i sigma / k, V."""
        return self._of_each("phase_speed")

    @property
    def error(self) -> np.ndarray:
        """Bounds of the absolute error of sigma."""
        return self._of_each("error")

    @property
    def status(self) -> tuple[Status, ...]:
        """"resolved", or what failed, of each."""
        return tuple(mode.status for mode in self.modes)

    def _of_each(self, name: str) -> np.ndarray:
        return np.array([getattr(mode, name) for mode in self.modes])
