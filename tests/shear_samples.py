"""Random velocities between walls, free edges and infinity, with U''; run as a script, the table of their references.

    python tests/shear_samples.py > tests/tables/recomputed_shear.csv
"""

from dataclasses import dataclass

import elements
import numpy as np
from sheared import jet, layer

from stability import flows, spectrum
from stability.errors import StabilityError

COUNT = 200
EDGES = ("wall", "free", "decay")
_BEYOND = 22.0  # widths beyond the last centre, where tanh is 1 to all digits
_AGREE = 1e-15


@dataclass(frozen=True)
class Velocity:
    """Up to three jets and shear layers, and between two edges a cubic, drawn from a seed."""

    seed: int
    bounded: bool

    def parts(self, z):
        """U, U' and U''."""
        rng = np.random.default_rng([77, self.seed])
        total = [0 * z, 0 * z, 0 * z]
        if self.bounded:
            a, b, c = rng.standard_normal(3)
            total = [a * z + b * z**2 + c * z**3, a + 2 * b * z + 3 * c * z**2, 2 * b + 6 * c * z]
        for kind in (jet, layer, jet)[: rng.integers(1, 4)]:
            height, centre, width = rng.uniform(0.3, 1.5), rng.uniform(-1, 1), 10 ** rng.uniform(-0.4, 0)
            for order, part in enumerate(kind(np.clip((z - centre) / width, -300, 300))):
                total[order] = total[order] + height * part / width**order
        return total

    def __call__(self, z):
        return self.parts(z)[0]


def draw(seed):
    """(flow, k) of a seed; the flow knows U alone."""
    rng = np.random.default_rng([78, seed])
    bottom, top = rng.choice(EDGES, 2).tolist()
    low = {} if bottom == "decay" else {"z_low": float(f"{rng.uniform(-2.5, -1.2):.3f}")}
    high = {} if top == "decay" else {"z_high": float(f"{rng.uniform(1.2, 2.5):.3f}")}
    flow = flows.Shear(Velocity(seed, "decay" not in (bottom, top)), Re=float(f"{10 ** rng.uniform(1, 3.3):.3g}"),
                       bottom=bottom, top=top, **low, **high)
    return flow, float(f"{10 ** rng.uniform(-0.7, 0.4):.3g}")


def reference(flow, k, sigma, count=1.0):
    """The growth rate next to sigma by spectral elements."""
    velocity = flow.profile.function
    low, high = (edge if np.isfinite(edge) else side * (1 + _BEYOND) for side, edge in
                 ((-1, flow.z_low), (1, flow.z_high)))
    return elements.growth(lambda z: velocity.parts(z)[0], lambda z: velocity.parts(z)[2], low, high, flow.Re, k, sigma,
                           (flow.bottom, flow.top), count=int(count * max(16, (high - low) / 0.3)), order=28)


def _write():
    print("# source: recomputed in extended precision by spectral elements (Orr-Sommerfeld), tests/elements.py,")
    print("#   with two numbers of elements, which agree to the last column; written by tests/shear_samples.py")
    print("# table: the least stable mode of random velocities; a seed tells velocity, edges, Re and k")
    print("# scaling: that of the velocities; exp(i k x + sigma t)")
    print("# digits: up to the last column")
    print("# known misprints: none")
    print("seed,sigma_real,sigma_imag,error")
    for seed in range(COUNT):
        flow, k = draw(seed)
        try:
            (mode,) = spectrum(flow, k, 1, strict=False).modes
            values = [reference(flow, k, mode.sigma, count) for count in (1.0, 1.4)]
        except (StabilityError, ArithmeticError) as reason:
            print(f"# {seed} is left out: {reason}")
            continue
        error = float(abs(values[1] - values[0]))
        print(f"{seed},{values[1].real!s},{values[1].imag!s},{max(error, 1e-18):.0e}", flush=True)


if __name__ == "__main__":
    _write()
