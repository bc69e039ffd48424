"""Linearise the nonlinear equations of a parallel flow about its flat state.

    inertia (dv/dt + v . grad v) = div stress + force,      div v = 0,
    stress = -p + eta(rate, p) (grad v + grad v^T),         rate^2 = |grad v + grad v^T|^2 / 2

for v = (U(z), 0, 0) plus a small wave exp(i k x + sigma t) along the flow, or exp(i k y + sigma t)
across it. Conditions are given on the displaced surface z = z0 + s and transferred to z = z0.

The thesis (chapter 4) writes exp(i k (x + c t)): its c is `speed` = sigma/(i k), minus ours.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import sympy as sp

x, y, z, time = sp.symbols("x y z time", real=True)
k = sp.Symbol("k", positive=True)
sigma = sp.Symbol("sigma")
amplitude = sp.Symbol("s0")
small = sp.Symbol("epsilon", positive=True)

FIELDS = sp.symbols("w u t n")
"""Normal velocity, velocity along the wave, shear stress, normal stress: the unknowns of `system`."""

u, v, w, p = (sp.Function(name)(z) for name in "uvwp")
"""The perturbation, as functions of z."""

U, P, eta, eta_rate, eta_pressure = (sp.Function(name)(z) for name in ("U", "P", "eta", "eta_rate", "eta_pressure"))
"""The base state, its viscosity and the viscosity's derivatives: names until `concrete` puts their values in."""


class NotASteadyState(ValueError):
    """The base flow does not satisfy the nonlinear equations, or not a condition."""


@dataclass(frozen=True)
class Linearisation:
    """A steady parallel flow, the nonlinear equations it solves, and the waves on it.

    velocity, pressure   base state U(z), p(z); U must increase with z
    viscosity            eta(rate, pressure)
    inertia, force       coefficient of the acceleration; body force (x, y, z)
    across               waves along y instead of x
    quasi_steady         leave d/dt out (a fluid much faster than its boundary)
    """

    velocity: sp.Expr
    pressure: sp.Expr
    viscosity: Callable[[sp.Expr, sp.Expr], sp.Expr]
    inertia: sp.Expr = sp.Integer(1)
    force: tuple[sp.Expr, sp.Expr, sp.Expr] = (sp.Integer(0), sp.Integer(0), sp.Integer(0))
    across: bool = False
    quasi_steady: bool = False

    def __post_init__(self) -> None:
        for row in self.momentum:
            residual = sp.simplify(self.concrete(row.subs(small, 0)))
            if residual != 0:
                raise NotASteadyState(
                    f"the base flow U = {self.velocity}, p = {self.pressure} does not satisfy the momentum "
                    f"equations (residual {residual}); check the body force and the friction law"
                )

    @cached_property
    def base(self) -> dict[sp.Expr, sp.Expr]:
        """Values of U, P, eta and the derivatives of eta at the base state."""
        rate, pressure = sp.symbols("rate pressure", positive=True)
        law = self.viscosity(rate, pressure)
        state = {rate: sp.diff(self.velocity, z), pressure: self.pressure}
        laws = {eta: law, eta_rate: sp.diff(law, rate), eta_pressure: sp.diff(law, pressure)}
        known = {U: self.velocity, P: self.pressure}
        return known | {name: sp.factor(value.subs(state)) for name, value in laws.items()}

    def concrete(self, expression: sp.Expr) -> sp.Expr:
        """Put the base state's values in."""
        return expression.subs(self.base).doit()

    @cached_property
    def wave(self) -> sp.Expr:
        return sp.exp(sp.I * k * (y if self.across else x) + sigma * time)

    @cached_property
    def along(self) -> sp.Expr:
        """The perturbation velocity in the direction of the wave."""
        return v if self.across else u

    @cached_property
    def full_velocity(self) -> sp.Matrix:
        """Base flow and perturbation. Waves along the flow leave the cross-slope velocity out: it decouples."""
        cross = v if self.across else 0
        return sp.Matrix([U, 0, 0]) + small * self.wave * sp.Matrix([u, cross, w])

    @cached_property
    def full_pressure(self) -> sp.Expr:
        return P + small * self.wave * p

    @cached_property
    def surface(self) -> sp.Expr:
        """Displacement s of the surface."""
        return small * self.wave * amplitude

    @cached_property
    def stress(self) -> sp.Matrix:
        """The full stress, exact up to first order in the perturbation."""
        gradient = self.full_velocity.jacobian([x, y, z])
        strain = gradient + gradient.T
        # rate = sqrt(|strain|^2/2), expanded here because sympy cannot know that U' > 0
        rate = sp.diff(sum(entry**2 for entry in strain) / 2, small).subs(small, 0) / (2 * sp.diff(U, z))
        viscosity = eta + small * (eta_rate * sp.expand(rate) + eta_pressure * self.wave * p)
        return -self.full_pressure * sp.eye(3) + viscosity * strain

    @cached_property
    def momentum(self) -> tuple[sp.Expr, ...]:
        """inertia * acceleration - div stress - force, with `small` in it; zero for a solution."""
        velocity = self.full_velocity
        acceleration = velocity.jacobian([x, y, z]) * velocity
        if not self.quasi_steady:
            acceleration += sp.diff(velocity, time)
        return tuple(self.inertia * acceleration[i] - self._divergence[i] - self.force[i] for i in range(3))

    @cached_property
    def _divergence(self) -> tuple[sp.Expr, ...]:
        return tuple(sum(sp.diff(self.stress[i, j], (x, y, z)[j]) for j in range(3)) for i in range(3))

    def first_order(self, expression: sp.Expr) -> sp.Expr:
        """Coefficient of the wave in the part of first order in the perturbation."""
        return sp.expand(sp.diff(expression, small).subs(small, 0) / self.wave)

    def equations(self) -> tuple[sp.Expr, ...]:
        """The linear momentum equations (x, y, z components) and continuity, as expressions that vanish."""
        return tuple(self.concrete(self.first_order(row)) for row in (*self.momentum, self.continuity))

    @cached_property
    def continuity(self) -> sp.Expr:
        return sum(sp.diff(self.full_velocity[i], (x, y, z)[i]) for i in range(3))

    def on_surface(self, condition: sp.Expr, at: sp.Expr) -> sp.Expr:
        """Transfer `condition` = 0 on z = at + s to z = at.

        Where the base state is singular a coefficient of a field may vanish at the surface while its
        product with the field does not, so those coefficients stay as they are, in terms of U, P and eta:
        take the limit z -> at after `concrete`.
        """
        flat = self.concrete(condition.subs(small, 0))
        if sp.simplify(flat.subs(z, at)) != 0:
            raise NotASteadyState(f"the flat state does not satisfy {flat} = 0 at z = {at}")
        here = self.first_order(condition)
        moved = here.coeff(amplitude, 1) + sp.diff(flat, z)
        return here.coeff(amplitude, 0) + amplitude * sp.simplify(self.concrete(moved).subs(z, at))

    @cached_property
    def kinematic(self) -> sp.Expr:
        """ds/dt + v . grad s - w, to be put on the surface."""
        s, velocity = self.surface, self.full_velocity
        return sp.diff(s, time) + velocity[0] * sp.diff(s, x) + velocity[1] * sp.diff(s, y) - velocity[2]

    def traction(self) -> sp.Matrix:
        """stress . normal on the displaced surface, with the unnormalised normal (-grad s, 1)."""
        return self.stress * sp.Matrix([-sp.diff(self.surface, x), -sp.diff(self.surface, y), 1])

    # -- the same equations as a first-order system in velocities and stresses -------------------

    @cached_property
    def _elimination(self) -> dict[sp.Expr, sp.Expr]:
        """p and the first derivatives of w and of the velocity along the wave, in terms of w, u, t, n."""
        W, V, shear, normal = FIELDS
        targets = dw, du, pressure = sp.symbols("dw du pressure")
        names = {sp.diff(w, z): dw, sp.diff(self.along, z): du, p: pressure, self.along: V, w: W}
        rows = [self.first_order(self._stress_along[2]) - shear,
                self.first_order(self.stress[2, 2]) - normal,
                self.first_order(self.continuity)]
        found = sp.solve([row.subs(names) for row in rows], targets, dict=True)[0]
        return {expression: found.get(name, name) for expression, name in names.items()}

    @cached_property
    def _stress_along(self) -> sp.Matrix:
        """The row of the stress that belongs to the direction of the wave."""
        return self.stress[1 if self.across else 0, :]

    def in_stresses(self, expression: sp.Expr) -> sp.Expr:
        """Write an expression of first order in u, w, p and their first derivatives with w, u, t, n."""
        return sp.expand(expression.subs(self._elimination))

    def surface_condition(self, condition: sp.Expr, at: sp.Expr) -> sp.Expr:
        """`on_surface` in terms of w, u, t, n at z = at."""
        linear = self.in_stresses(self.on_surface(condition, at))
        return sum(self._base_at(sp.cancel(linear.coeff(unknown)), at) * unknown for unknown in (*FIELDS, amplitude))

    def _base_at(self, expression: sp.Expr, height: sp.Expr) -> sp.Expr:
        """Put the base state at z = height into an expression without derivatives of the perturbation."""
        base = {**self.base, sp.diff(U, z): sp.diff(self.velocity, z)}
        return expression.subs({name: sp.cancel(value.subs(z, height))
                                for name, value in base.items() if expression.has(name)})

    def system(self, height: sp.Expr = z) -> sp.Matrix:
        """Matrix M of d(w, u, t, n)/dz = M (w, u, t, n) at z = height.

        The down-slope velocity of a wave across the flow is left out: it follows from the others.
        """
        direction, normal = (1 if self.across else 0), 2
        coordinate = (x, y)[direction]
        inertia = [self.first_order(self.momentum[i] + self._divergence[i]) for i in (direction, normal)]
        slopes = [self._elimination[sp.diff(w, z)],
                  self._elimination[sp.diff(self.along, z)],
                  self.in_stresses(inertia[0] - self.first_order(sp.diff(self._stress_along[direction], coordinate))),
                  self.in_stresses(inertia[1]) - sp.I * k * FIELDS[2]]
        return sp.Matrix([[sp.cancel(self._base_at(sp.expand(slope).coeff(unknown), height)) for unknown in FIELDS]
                          for slope in slopes])
