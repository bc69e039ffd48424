"""What a reader of the usual textbooks writes for the same eigenvalues: collocation at Chebyshev points in z.

    vortex(slope_deg, Fr2, k, n, delta=0)            inclined plane, W and P at n + 1 points, dense QZ
    dune(shields, mu1, b, Re, k, n, cut=100)         bed in W and P; fluid cut at z = cut / k, D^4 at 2 n points
    poiseuille(Re, k, n)                             clamped fourth-order collocation
    cut_response(k, Re, height, n)                   wall stress of a fluid cut at a height
    poiseuille_dmsuite(Re, k, n)                     the same matrices from the package dmsuite, where it is installed
    poiseuille_dedalus(Re, k, n, near)               velocities and pressure in Dedalus 3, where it is installed
    EvenGalerkin(n)                                  even modes alone, n Legendre functions, one mode followed

Each but the last returns all finite eigenvalues sigma of exp(i k x + sigma t), or the response. With P and W the
perturbations of pressure and vertical velocity, a granular layer obeys (from (4.14), (4.15) and their analogues)

    t = beta (i/k) (W'' + k^2 W) + alpha P,     n = -P + 2 eta W',     u = i W'/k,
    t' = rho [(sigma + i k U) u + U' W] - i k n + 4 k^2 eta u,         n' = rho (sigma + i k U) W - i k t.
"""

from math import radians, tan

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eig, lapack


def chebyshev(n, low, high):
    """Points (n+1,) from low to high and the differentiation matrix, Trefethen's cheb.m turned round."""
    x = -np.cos(np.pi * np.arange(n + 1) / n)
    c = np.r_[2, np.ones(n - 1), 2] * (-1) ** np.arange(n + 1)
    dx = x[:, None] - x[None, :] + np.eye(n + 1)
    D = np.outer(c, 1 / c) / dx
    D -= np.diag(D.sum(axis=1))
    return low + (high - low) * (x + 1) / 2, 2 * D / (high - low)


def finite(A, B):
    """Eigenvalues of A x = sigma B x that scipy's QZ does not call infinite, by decreasing real part."""
    values = eig(A, B, right=False)
    values = values[np.isfinite(values)]
    return values[np.argsort(-values.real)]


def vortex(slope_deg, Fr2, k, n, delta=0.0):
    """Thesis (4.14), (4.15), (4.17), (4.19), (4.20) at Chebyshev points in z, or with delta (4.26)-(4.29)."""
    z, D = chebyshev(n, 0, 1)
    eye, zero = np.eye(n + 1), np.zeros((n + 1, n + 1))
    inside = slice(1, n)
    root = np.sqrt(1 + delta - z[inside])
    T = tan(radians(slope_deg))
    eta, slope = (T * root)[:, None], (-T / (2 * root))[:, None]
    D2 = D @ D
    bend = D2 + k**2 * eye  # W'' + k^2 W
    bend_slope = D @ bend
    # k^2 P = [eta bend]' - 2 k^2 eta W' - rho sigma W',   P' = 2 (eta W')' - eta bend - rho sigma W
    along = eta * bend_slope[inside] + slope * bend[inside] - 2 * k**2 * eta * D[inside]
    along = np.hstack((along, -k**2 * eye[inside]))
    across = np.hstack((2 * eta * D2[inside] + 2 * slope * D[inside] - eta * bend[inside], -D[inside]))
    edges = np.zeros((4, 2 * n + 2))
    edges[0, : n + 1] = eye[0]
    edges[1, : n + 1] = D[0]
    edges[2, : n + 1] = bend[n]
    edges[3, : n + 1] = eye[n]  # W = sigma (P - 2 sqrt(delta) T W')
    A = np.vstack((along, across, edges))
    moving = np.zeros((4, 2 * n + 2))
    moving[3, n + 1:] = eye[n]
    moving[3, : n + 1] = -2 * np.sqrt(delta) * T * D[n]
    B = np.vstack((np.hstack((Fr2 * D[inside], zero[inside])), np.hstack((Fr2 * eye[inside], zero[inside])), moving))
    return finite(A, B)


def dune(shields, mu1, b, Re, k, n, cut=100.0, R=None):
    """Granular bed (4.52), (4.64)-(4.70) in z, with the fluid cut at z = cut / k as in the thesis, or its R given."""
    z, D = chebyshev(n, 1 - shields, 0)
    eye = np.eye(n + 1)
    inside = slice(1, n)
    D2 = D @ D
    p = 1 - z
    root = np.sqrt(p)
    dU = (shields - p) / (b * root)  # (4.52); U vanishes at the yield surface
    U = (2 / 3 * (p**1.5 - shields**1.5) - 2 * shields * (root - np.sqrt(shields))) / b
    beta, alpha = mu1 * b * root, mu1 * (shields + p) / (2 * p)
    with np.errstate(divide="ignore"):
        eta = mu1 * shields / dU
    beta_t = (1j / k) * beta[:, None] * (D2 + k**2 * eye)
    stress = np.hstack((beta_t, np.diag(alpha)))  # t on (W, P)
    columns = 2 * n + 3
    A, B = np.zeros((2, columns, columns), complex)
    u = 1j / k * D
    W, P, s0 = slice(0, n + 1), slice(n + 1, 2 * n + 2), 2 * n + 2
    # rho (sigma + i k U) u = t' - U' W + i k n - 4 k^2 eta u, with n = -P + 2 eta W'
    rows = slice(0, n - 1)
    A[rows, : s0] = (D @ stress)[inside]
    A[rows, W] += (-np.diag(dU) - 1j * k * U[:, None] * u)[inside]
    A[rows, W] += (2j * k * eta[inside, None] * D[inside] - 4 * k**2 * eta[inside, None] * u[inside])
    A[rows, P] -= 1j * k * eye[inside]
    B[rows, W] = u[inside]
    # (sigma + i k U) W = n' + i k t
    rows = slice(n - 1, 2 * n - 2)
    slope = eta_slope(shields, mu1, b, p[inside])
    A[rows, : s0] = 1j * k * stress[inside]
    A[rows, W] += 2 * eta[inside, None] * D2[inside] + 2 * slope[:, None] * D[inside] - 1j * k * np.diag(U)[inside]
    A[rows, P] -= D[inside]
    B[rows, W] = eye[inside]
    R = cut_response(k, Re, cut / k, 2 * n) if R is None else R
    end = 2 * n - 2
    A[end, W], A[end + 1, W] = eye[0], D[0]
    A[end + 2, P], A[end + 2, s0] = eye[n], -1
    A[end + 3, : s0], A[end + 3, s0] = stress[n], mu1 * shields * R
    A[end + 4, W], A[end + 4, s0], B[end + 4, s0] = eye[n], -1j * k * U[n], 1
    return finite(A, B)


def eta_slope(shields, mu1, b, p):
    """d eta / dz of eta = mu1 shields b sqrt(p) / (shields - p), p = 1 - z."""
    root = np.sqrt(p)
    return -mu1 * shields * b * (0.5 / root / (shields - p) + root / (shields - p) ** 2)


def cut_response(k, Re, height, n):
    """R = Psi''(0) of (4.59)-(4.63) with a rigid lid, by collocation of the fourth derivative."""
    z, D = chebyshev(n, 0, height)
    eye = np.eye(n + 1)
    laplace = D @ D - k**2 * eye
    A = (laplace @ laplace / Re - 1j * k * z[:, None] * laplace).astype(complex)
    right = np.zeros(n + 1, complex)
    A[0], A[1], A[n], A[n - 1] = eye[0], D[0], eye[n], D[n]
    right[1] = 1
    return (D @ D @ np.linalg.solve(A, right))[0]


def poiseuille(Re, k, n):
    """Clamped Orr-Sommerfeld on the n - 1 interior points: Trefethen, Spectral Methods in MATLAB, program 40."""
    y, D = chebyshev(n, -1, 1)
    inside = slice(1, n)
    D2 = D @ D
    clamp = np.diag(np.r_[0, 1 / (1 - y[inside] ** 2), 0])
    D4 = (np.diag(1 - y**2) @ D2 @ D2 - 8 * np.diag(y) @ D2 @ D - 12 * D2) @ clamp
    D2, D4, y = D2[inside, inside], D4[inside, inside], y[inside]
    eye = np.eye(n - 1)
    laplace = D2 - k**2 * eye
    A = (D4 - 2 * k**2 * D2 + k**4 * eye) / Re - 2j * k * eye - 1j * k * np.diag(1 - y**2) @ laplace
    return finite(A, laplace)


def poiseuille_dmsuite(Re, k, n):
    """Orr-Sommerfeld at n inner points: Weideman & Reddy (2000), function orrsom of their suite, at any k."""
    from dmsuite.cheb_bc import cheb4c
    from dmsuite.poly_diff import Chebyshev

    D2 = Chebyshev(degree=n + 1).at_order(2)[1:-1, 1:-1]
    y, D4 = cheb4c(n + 1)
    eye = np.eye(n)
    laplace = D2 - k**2 * eye
    A = (D4 - 2 * k**2 * D2 + k**4 * eye) / Re - 2j * k * eye - 1j * k * np.diag(1 - y**2) @ laplace
    return finite(A, laplace)


def poiseuille_dedalus(Re, k, n, near=None):
    """Velocities and pressure in n Chebyshev coefficients by Dedalus 3 (Burns et al. 2020): all eigenvalues by its
    dense solver, or the one nearest to `near` by its sparse one."""
    import dedalus.public as d3

    axis = d3.Coordinate("z")
    space = d3.Distributor(axis, dtype=np.complex128)
    basis = d3.ChebyshevT(axis, n, bounds=(-1, 1))
    z, slopes = space.local_grid(basis), basis.derivative_basis(1)
    names = {name: space.Field(name=name, bases=basis) for name in ("p", "u", "w", "U", "dU")}
    names |= {name: space.Field(name=name) for name in ("sigma", "a", "b", "c", "d")}
    names["U"]["g"], names["dU"]["g"] = 1 - z**2, -2 * z

    def slope(field):
        return d3.Differentiate(field, axis)

    def lift(constant):
        return d3.Lift(constant, slopes, -1)

    names |= {"slope": slope, "lift": lift, "ik": 1j * k, "kk": k**2, "nu": 1 / Re,
              "uz": slope(names["u"]) + lift(names["a"]), "wz": slope(names["w"]) + lift(names["b"])}
    unknowns = [names[name] for name in ("p", "u", "w", "a", "b", "c", "d")]
    problem = d3.EVP(unknowns, eigenvalue=names["sigma"], namespace=names)
    for equation in ("ik*u + wz = 0", "u(z=-1) = 0", "u(z=1) = 0", "w(z=-1) = 0", "w(z=1) = 0",
                     "sigma*u + ik*U*u + dU*w + ik*p - nu*slope(uz) + nu*kk*u + lift(c) = 0",
                     "sigma*w + ik*U*w + slope(p) - nu*slope(wz) + nu*kk*w + lift(d) = 0"):
        problem.add_equation(equation)
    solver = problem.build_solver()
    if near is None:
        solver.solve_dense(solver.subproblems[0])
    else:
        solver.solve_sparse(solver.subproblems[0], 1, near)
    return solver.eigenvalues[np.isfinite(solver.eigenvalues)]


class EvenGalerkin:
    """Plane Poiseuille flow by n even clamped combinations of Legendre polynomials (Shen 1994), a mode at a time.

    With phi = sum a_j f_j and tests f_i the Orr-Sommerfeld equation is A a = c B a, B = K + k^2 M and
    A = K_U + k^2 M_U - 2 M - i/(k Re) (S + 2 k^2 K + k^4 M); M, K, S have the products of f, f', f''.
    """

    def __init__(self, n=64):
        even = 2 * np.arange(n)
        C = np.zeros((2 * n + 3, n))
        for j, column in zip(even, C.T, strict=True):
            column[[j, j + 2, j + 4]] = np.array([1, -2 * (2 * j + 5) / (2 * j + 7), (2 * j + 3) / (2 * j + 7)]) / (
                np.sqrt(2 * (2 * j + 3) ** 2 * (2 * j + 5)))
        z, weight = legendre.leggauss(2 * n + 6)
        f, slope, bend = (legendre.legval(z, legendre.legder(C, order) if order else C).T for order in range(3))
        w, U = weight[:, None], (1 - z**2)[:, None]
        self.M, self.K, self.S = (g.T @ (w * g) for g in (f, slope, bend))
        self.MU, self.KU = f.T @ (w * U * f), slope.T @ (w * U * slope) + f.T @ (w * (-2 * z)[:, None] * slope)

    def pair(self, Re, k):
        viscous = self.S + 2 * k**2 * self.K + k**4 * self.M
        return self.KU + k**2 * self.MU - 2 * self.M - 1j / (k * Re) * viscous, self.K + k**2 * self.M

    def followed(self, points, tolerance=1e-12):
        """c of the least stable even mode at the first of the points (Re, k), followed through the others."""
        values, vectors = eig(*self.pair(*points[0]))
        c, x, found = values[values.imag.argmax()], vectors[:, values.imag.argmax()], []
        for point in points:
            A, B = self.pair(*point)
            c, before = _ahead(found[-3:]) if found else c, np.inf
            factors, pivots, _ = lapack.zgetrf(A - c * B)
            for _ in range(9):
                z = lapack.zgetrs(factors, pivots, B @ x)[0]
                largest = np.abs(x).argmax()
                change, x = x[largest] / z[largest], z / z[largest]
                if abs(change - before) < tolerance * abs(c):
                    break
                before = change
            found.append(c + change)
        return np.array(found)


def _ahead(values):
    """The next of evenly spaced values, by a parabola through the last three, a line, or none."""
    return values[-1] if len(values) < 2 else 2 * values[-1] - values[-2] if len(values) < 3 else (
        3 * values[2] - 3 * values[1] + values[0])
