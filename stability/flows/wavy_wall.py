"""Shear stress of a fluid in linear shear over a wavy rigid wall.

The fluid U = z fills 0 < z < depth above the wall z = s0 exp(i k x). Its streamfunction
perturbation Psi(z) exp(i k x) obeys Cawthorn (4.59)-(4.63),

    i k z (D^2 - k^2) Psi = (1/Re) (D^2 - k^2)^2 Psi,    D = d/dz,
    Psi = 0, Psi' = s0 at z = 0;    Psi = Psi' = 0 at z = depth, or decay if depth is infinite,

and the wall feels the shear stress R s0, R = Psi''(0)/s0. Lengths are in one scale L, velocities in
(shear rate) L, and Re = (shear rate) L^2 / viscosity.

With f = (i k Re)^(1/3), q = k/f, x = q^2 + f z the vorticity omega = (D^2 - k^2) Psi obeys Airy's
equation d^2 omega / dx^2 = x omega. Two methods, which meet where both are exact to rounding:

* `_layers`: one vorticity layer at the bed and one at the lid. Every moment of an Airy function is
  an average over a saddle point, taken with the trapezoidal rule.
* `_gap`: a gap too thin for two layers. Legendre-Galerkin, whose error in R is that of Psi squared.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

import numpy as np

from ..errors import ParameterError

EPS = np.finfo(float).eps
LID_FELT = 22.0  # beyond this k depth a lid changes R by about (2 k depth)^2 exp(-2 k depth) < EPS
LAYERS_PART = 18.0  # beyond this |f| depth a layer at one wall has decayed to EPS at the other
GALERKIN_MODES = 36  # Galerkin modes: R to rounding up to k depth = LID_FELT and |f| depth = LAYERS_PART
NODES = 0.24 * np.arange(-26, 27)  # trapezoidal rule for weights like exp(-v^2)
BLOCK = 256  # wavenumbers done at once: bounds the memory
TURN = np.exp(1j * np.pi / 3)


@dataclass(frozen=True, eq=False)
class Response:
    """R = Psi''(0)/s0 with its derivatives; arrays have the shape of `k`.

    `error` estimates the absolute error of `value`. The derivatives are analytic; their errors are
    roundings of |R|/k, |R|/Re and |R|/depth.
    """

    k: np.ndarray  # a number if one was given, as for all the others
    Re: float
    depth: float
    value: np.ndarray
    derivative: np.ndarray  # dR/dk
    d_Re: np.ndarray
    d_depth: np.ndarray
    error: np.ndarray


def response(k: np.ndarray, Re: float, depth: float = np.inf) -> "Response":
    """Response R(k, Re, depth) of the wall's shear stress to the wall's height: a `Response`.

    `k` is a wavenumber or a 1-D array of them. Checked over 1e-6 <= k <= 1e3, 1e-4 <= Re <= 1e6,
    0.1 <= depth <= inf. Raises ParameterError (a ValueError) unless all are positive, k and Re finite.

    >>> complex(response(10, 1).value.round(12))
    (-20.000437263748-0.049991570992j)
    """
    k, Re, depth = np.array(k, dtype=float), float(Re), float(depth)
    _check(k, Re, depth)
    flat = k.reshape(-1)
    felt = flat * depth < LID_FELT
    thin = felt & (np.cbrt(flat) * np.cbrt(Re) * depth < LAYERS_PART)
    rows = np.empty((5, flat.size), dtype=complex)
    methods = (_gap, thin), (partial(_layers, _lid), felt & ~thin), (partial(_layers, _no_lid), ~felt)
    for method, where in methods:
        chosen = np.flatnonzero(where)
        for start in range(0, chosen.size, BLOCK):
            block = chosen[start : start + BLOCK]
            rows[:, block] = method(flat[block], Re, depth)
    value, by_k, by_Re, by_depth, error = rows.reshape((5, *k.shape))
    return Response(k[()], Re, depth, value, by_k / k, by_Re / Re, by_depth / depth, error.real)


def boundary_layer(k: Any, Re: Any) -> Any:
    """R as k^2/Re -> 0 without a lid: -(3^(1/3)/Gamma(2/3)) (i k Re)^(1/3), Cawthorn (4.71)."""
    return -(3 ** (1 / 3) / math.gamma(2 / 3)) * _airy_scale(k, Re)


def shallow(k: Any, Re: Any, depth: Any) -> Any:
    """R as k depth -> 0 and k Re depth^3 -> 0: -4/depth - i k depth^2 Re/30, Cawthorn (4.83)."""
    return -4 / depth - 1j * k * depth**2 * Re / 30


def short_wave(k: Any, Re: Any) -> Any:
    """R as k^2/Re -> inf without a lid: -2 k - i Re/(2 k), Stokes flow and its first correction by inertia."""
    return -2 * k - 0.5j * Re / k


def _check(k: np.ndarray, Re: float, depth: float) -> None:
    """Raise ParameterError, naming the parameter and its value, unless `response` is defined."""
    if k.ndim > 1:
        raise ParameterError(f"k must be a number or a 1-D array (got shape {k.shape})")
    bad = k[~((k > 0) & (k < np.inf))]
    if bad.size:
        raise ParameterError(f"k must be positive and finite: R is the response to a wave (got {bad[0]})")
    if not 0 < Re < np.inf:
        raise ParameterError(f"Re must be positive and finite: f = (i k Re)^(1/3) is a scale (got {Re})")
    if not depth > 0:
        raise ParameterError(f"depth must be positive, inf for no lid (got {depth})")


def _airy_scale(k: np.ndarray, Re: float) -> np.ndarray:
    """f = (i k Re)^(1/3)."""
    return np.cbrt(k) * np.cbrt(Re) * np.exp(1j * np.pi / 6)


# Layers. As Ai(x) = Int exp(t^3/3 - x t) dt / (2 pi i), each moment of the vorticity A = Ai(x) is an average
# <g> = Int g(t) exp(t^3/3 - x t) dt / Int exp(t^3/3 - x t) dt over a path that leaves the poles of g to
# its left. Without a lid, (D^2 - k^2) Psi = omega times exp(-k z), integrated by parts, gives
#     R = -A(0) / Int_0^inf A exp(-k z) dz = -f/J,    J = <1/(t + q)> at x = q^2.
# A lid adds B = Ai(exp(2 i pi/3) x), which decays downwards from it, and Int omega sinh(k z) dz = 0:
#     R = -f/(J - W),    W = c S,    S = f^2 Int A sinh(k z)/k dz / A(0) = <1/(t^2 - q^2)>,
#     c = Int B exp(-k z) dz / (f Int B sinh(k z)/k dz).


def _layers(lid: Callable[..., Any], k: np.ndarray, Re: float, depth: float) -> tuple[Any, ...]:
    """Rows R, k dR/dk, Re dR/dRe, depth dR/d(depth), error, shaped like `k`; `lid` is `_lid` or `_no_lid`."""
    f = _airy_scale(k, Re)
    q = k / f
    shift = 1.4 / (1 + abs(q))  # keeps the poles t = q and t = -q at a distance
    tau, weight = _saddle(q, shift, 1 / np.sqrt(q.real + shift))
    pole = 1 / (tau + 2 * q[:, None])
    J = _mean(weight, pole)

    # D = 1 - 2 q J = <tau pole> is small for short waves; its own derivative (at fixed tau) keeps its digits.
    spread = tau**2 - _mean(weight, tau**2)[:, None]
    D_q = _mean(weight, tau * pole * (spread - 2 * pole))
    W, W_q, W_eta, W_error = lid(f, q, depth, tau, weight)

    # f ~ (k Re)^(1/3) and q ~ k^(2/3) Re^(-1/3); q dJ/dq = -J - D_q/2
    R = -f / (J - W)
    third = R / (3 * (J - W))
    by_k = third * (3 * J + D_q - W + 2 * W_q + W_eta)
    by_Re = third * (W_eta - W_q - W - D_q / 2)
    error = abs(R / (J - W)) * (abs(J) * _error(weight, pole) + W_error)
    return R, by_k, by_Re, 3 * third * W_eta, error


def _no_lid(f: np.ndarray, q: np.ndarray, depth: float, tau: np.ndarray, weight: np.ndarray) -> tuple[float, ...]:
    """W and its derivatives, as from `_lid`, where the lid is out of reach."""
    return 0.0, 0.0, 0.0, 0.0


def _lid(f: Any, q: Any, depth: Any, tau: Any, weight: Any) -> Any:
    """W, q dW/dq, eta dW/d(eta) and the error of W, each shaped like `q`; eta = f depth.

    `tau`, `weight` average over the bed's layer, x = q^2. At the distance d below the lid B = Ai(y + s d/depth)
    with y = exp(2 i pi/3) (q^2 + eta), s = exp(-i pi/3) eta, r = exp(i pi/3) q, so that at x = y
    c = exp(-i pi/3) <1/(t - r)> / N,   N = s <1/(t + r)> (exp(2 k depth) - 1)/(2 k depth) - <1/(t^2 - r^2)>.
    """
    eta = f * depth
    pole = 1 / (tau * (tau + 2 * q[:, None]))
    S = _mean(weight, pole)
    S_q = 2 * q**2 * _mean(weight, pole * (pole - tau + _mean(weight, tau)[:, None]))

    r, s = TURN * q, eta / TURN
    p = TURN * np.sqrt(q**2 + eta)
    # steepest descent; it may leave t = r and t = -r to its right, but their residues are the layer's value at the bed
    tau, weight = _saddle(p, 0 * p, 1 / np.sqrt(p))
    spread = _mean(weight, tau)[:, None] - tau  # d<g>/dy = <g spread>; y = exp(2 i pi/3) q^2 - s
    down, up = 1 / (tau + (p - r)[:, None]), 1 / (tau + (p + r)[:, None])
    both = down * up
    g = np.array([down, up, both])
    means, by_y = _mean(weight, g), _mean(weight, g * spread)
    by_r = _mean(weight, np.array([down**2, -(up**2), 2 * r[:, None] * both**2]))
    # each with three rows: <g>, q d<g>/dq, eta d<g>/d(eta)
    top, bottom, N = np.array([means, r * by_r + 2 * r**2 * by_y, -s * by_y]).swapaxes(0, 1)

    twice = 2 * (q * eta).real
    grown, mean_grown = np.exp(twice), np.expm1(twice) / twice
    N = s * mean_grown * bottom - N
    N[1:] += s * bottom[0] * np.array([grown - mean_grown, grown])
    W = S * top[0] / (TURN * N[0])
    W_q, W_eta = W * (top[1:] / top[0] - N[1:] / N[0])
    return W, W_q + W * S_q / S, W_eta, abs(W) * _error(weight, down) + EPS * abs(S)


def _saddle(p: np.ndarray, shift: np.ndarray, scale: np.ndarray) -> tuple[np.ndarray, ...]:
    """Nodes tau = t - p and weights of the average over exp(t^3/3 - p^2 t); each (p.size, NODES.size).

    On the straight line tau = shift + i scale v past the saddle tau = 0 the trapezoidal rule in v converges
    geometrically.
    """
    tau = shift[:, None] + 1j * scale[:, None] * NODES
    weight = np.exp(tau**2 * (p[:, None] + tau / 3))
    return tau, weight / weight.sum(axis=1, keepdims=True)


def _mean(weight: np.ndarray, g: np.ndarray) -> np.ndarray:
    return np.einsum("...j,...j->...", weight, g)


def _error(weight: np.ndarray, g: np.ndarray) -> np.ndarray:
    """Relative error of <g>: rounding, and the square of what leaving out every second node changes."""
    coarse = _mean(weight[:, ::2], g[:, ::2]) / weight[:, ::2].sum(axis=1)
    return 8 * EPS + abs(coarse / _mean(weight, g) - 1) ** 2


# Gap. With z in units of depth, kappa = k depth and F = i k Re depth^3, multiplying the equation by any v with
# v = v' = 0 at z = 1, v = 0 at z = 0 and integrating by parts gives
#     depth R v'(0) = -a(Psi, v),    a(Psi, v) = Int Psi'' v'' + 2 kappa^2 Psi' v' + kappa^4 Psi v
#                                                    - F z v (Psi'' - kappa^2 Psi) dz.
# Psi = e_0 + sum c_j e_j and its adjoint Psi* make a(Psi, e_j) = a(e_j, Psi*) = 0, j >= 1. Then
# depth R = -a(Psi, Psi*), stationary in both, so that its derivatives are those of a at fixed Psi, Psi*.


def _gap(k: Any, Re: Any, depth: Any) -> Any:
    """Rows R, k dR/dk, Re dR/dRe, depth dR/d(depth), error of a thin gap; each shaped like `k`."""
    bend, slope, value, moment, shear = matrices = _clamped_basis()
    K = ((k * depth) ** 2)[:, None, None]
    F = (k * Re * depth**3)[:, None, None]
    form = np.empty((k.size, *bend.shape), dtype=complex)
    form.real = bend + K * (2 * slope + K * value)
    form.imag = F * (K * moment - shear)
    psi = _galerkin(form)
    adjoint = _galerkin(form.transpose(0, 2, 1))

    K, F = K[:, 0, 0], 1j * F[:, 0, 0]
    g = -_mean(form[:, 0], psi)
    _, slope, value, moment, shear = np.einsum("mni,ni->mn", adjoint @ matrices, psi)
    by_kappa = -2 * K * (2 * slope + 2 * K * value + F * moment)
    by_F = F * (shear - K * moment)
    rounding = 4 * EPS * _mean(abs(form[:, 0]), abs(psi))
    truncation = abs(psi[:, -2:]).sum(axis=1) * abs(adjoint[:, -2:]).sum(axis=1)
    return np.array([g, by_kappa + by_F, by_F, by_kappa + 3 * by_F - g, rounding + truncation]) / depth


def _galerkin(form: np.ndarray) -> np.ndarray:
    """Coefficients (n, MODES + 1), the first one 1, with form[:, i] . coefficients = 0 for i >= 1."""
    rest = np.linalg.solve(form[:, 1:, 1:], -form[:, 1:, :1])[..., 0]
    return np.concatenate([np.ones((len(rest), 1)), rest], axis=1)


@lru_cache(maxsize=1)
def _clamped_basis() -> np.ndarray:
    """Matrices Int e_i'' e_j'', e_i' e_j', e_i e_j, z e_i e_j, z e_i e_j'' dz over 0 < z < 1; i, j = 0..MODES.

    e_0 = z (1 - z)^2 carries Psi'(0) = 1. The others are clamped at both ends and e_j'' are the
    orthonormal Legendre polynomials of degree j + 1. Every product is summed in Legendre
    coefficients: quadrature would leave ten times the rounding.
    """
    degree = np.arange(GALERKIN_MODES + 5)
    odd = 2 * degree + 1
    integral = (np.diag(1 / odd[:-1], 1) - np.diag(1 / odd[1:], -1)) / 2
    times_z = (np.eye(odd.size) + np.diag(degree[1:] / odd[:-1], 1) + np.diag(degree[1:] / odd[1:], -1)) / 2
    second = np.eye(GALERKIN_MODES + 1, odd.size, 1) * np.sqrt(odd)
    second[0, :2] = -1, 3
    first = second @ integral
    first[0, :3] = 0, -1 / 2, 1 / 2
    basis = first @ integral
    basis[0, :4] = 1 / 12, -1 / 20, -1 / 12, 1 / 20

    moved = basis @ times_z
    pairs = (second, second), (first, first), (basis, basis), (moved, basis), (moved, second)
    return np.array([(a / odd) @ b.T for a, b in pairs])
