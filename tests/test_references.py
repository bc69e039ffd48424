"""The multi-precision references against published numbers, quadrature, limits and themselves."""
import random

import mpmath as mp
import pytest
import references
from references import couette, dune, film, poiseuille, rollwave, two_layer_couette, vortex, wall_response
from twins import table

# k, Re, depth, -R to 22 significant digits: exact Airy integrals.
WAVY_WALL = [
    ("0.01", 1, mp.inf, "0.2071675407392294604801", "0.1146310767157079453923"),
    ("1", 100, mp.inf, "5.190678379511007508127", "2.423213487768535743844"),
    ("10", 1, mp.inf, "20.00043726374801432638", "0.04999157099198811850727"),
    ("1", 10, 1, "4.294126620559937806775", "0.3381733070145952776819"),
    ("0.1", 100, 5, "2.181002839902109282769", "1.135878208670128566388"),
]
# k, sigma for slope 30 degrees, Fr2 = 1/10: Chebyshev collocation in zeta at degree 32.
VORTICES = [("0.1", -0.006851895881), ("0.5", -0.135031081668), ("1", -0.319525958278), ("2", -0.452930272740),
            ("2.5", -0.455940697112), ("3", -0.442809450660), ("4", -0.401703263721), ("10", -0.256698267600)]
# shields, mu1, b, Re, depth, k, sigma: Chebyshev collocation in zeta at degrees 30 and 50.
DUNES = [
    (("2", "0.4", 1, 10, mp.inf, 1), 0.2343399716 - 1.0091510540j),
    (("2", "0.4", 1, 10, mp.inf, 1), -4.6153386484 + 0.9541920554j),
    (("1.05", "0.7", 1, 10, mp.inf, 10), 7327.015171 + 24715.491077j),
    (("1.05", "0.7", 1, 10, mp.inf, 10), -0.1005653813 - 0.1330376213j),
]


def agree(a, b, digits):
    return abs(a - b) < mp.mpf(10) ** -digits * abs(b)


def long_wave_vortex(slope_deg, k):
    return -2 * k**2 / (5 * mp.tan(mp.radians(slope_deg)))


def long_wave_dune(shields, b, R, k):
    return 2j * k * shields / (3 * b) * (shields**1.5 - 3 * shields**0.5 + 2) * R


def followed(solve, limit, k_end):
    """The mode that starts as limit(k), followed to k_end by extrapolating log sigma in log k."""
    k, step = mp.mpf("1e-3"), mp.mpf("1.25")
    before, sigma = limit(k / step), solve(k, limit(k), radius=0.2)
    while k < k_end:
        after = min(k * step, k_end)
        guess = sigma * (sigma / before) ** mp.log(after / k, step)
        k, before, sigma = after, sigma, solve(after, guess, digits=12, radius=0.2)
    return sigma


@pytest.mark.parametrize(("k", "Re", "depth", "real", "imag"), WAVY_WALL)
def test_wavy_wall_table(k, Re, depth, real, imag):
    with mp.workdps(30):
        T = -wall_response(k, Re, depth)
        for part, printed in (T.real, real), (T.imag, imag):
            half_unit = mp.mpf(10) ** -len(printed.partition(".")[2]) / 2
            assert abs(part - mp.mpf(printed)) <= half_unit


def test_wall_response_is_the_airy_integral():
    with mp.workdps(26):
        k, Re, h = mp.mpf("0.7"), 20, 2
        f = mp.root(1j * k * Re, 3)
        x0 = (k / f)**2
        edges = mp.linspace(0, 8, 5)
        free = -mp.airyai(x0) / mp.quad(lambda z: mp.airyai(x0 + f * z) * mp.exp(-k * z), edges)
        assert agree(wall_response(k, Re), free, 20)

        def moments(airy):
            up, down = (mp.quad(lambda z, s=s: airy(x0 + f * z) * mp.exp(s * k * z), edges[:2]) for s in (1, -1))
            return up + down, up - down

        (ai_cosh, ai_sinh), (bi_cosh, bi_sinh) = moments(mp.airyai), moments(mp.airybi)
        lid = 2 * (mp.airybi(x0) * ai_sinh - mp.airyai(x0) * bi_sinh) / (ai_cosh * bi_sinh - bi_cosh * ai_sinh)
        assert agree(wall_response(k, Re, h), lid, 20)


def test_wall_response_limits():
    k, Re, h = mp.mpf("1e-6"), 2, 3
    layer = -mp.cbrt(3) / mp.gamma(mp.mpf(2) / 3) * mp.root(1j * k * Re, 3) - 9 * k / (2 * mp.pi * mp.sqrt(3))
    assert agree(wall_response(k, Re), layer, 6)
    shallow = -4 / mp.mpf(h) - 1j * k * Re * h**2 / 30 - mp.mpf(4) / 15 * h * k**2 + (1j * k * Re)**2 * h**5 / 4200
    assert agree(wall_response(k, Re, h), shallow, 14)
    assert agree(wall_response(10, mp.mpf("0.01")), -20 - mp.mpc(0, "0.0005"), 8)


@pytest.mark.parametrize(("k", "sigma"), VORTICES)
def test_vortices(k, sigma):
    assert abs(vortex(30, mp.mpf("0.1"), mp.mpf(k), sigma) - sigma) < 5e-13
    with pytest.raises(ArithmeticError, match="no root within"):
        vortex(30, mp.mpf("0.1"), mp.mpf(k), 1.01 * sigma)


def test_vortices_depend_on_inertia():
    k, sigma = VORTICES[2]
    assert abs(vortex(30, mp.mpf("0.101"), mp.mpf(k), sigma, radius=0.1) - sigma) > 1e-6


@pytest.mark.parametrize(("flow", "sigma"), DUNES)
def test_dunes(flow, sigma):
    shields, mu1, *rest = flow
    shields, mu1 = mp.mpf(shields), mp.mpf(mu1)
    assert agree(dune(shields, mu1, *rest, sigma), sigma, 9)
    assert not agree(dune(shields, mu1 * 1.01, *rest, sigma, radius=0.1), sigma, 5)
    with pytest.raises(ArithmeticError, match="no root within"):
        dune(shields, mu1, *rest, 1.01 * sigma)


def test_vortex_long_waves():
    error = []
    for k in mp.mpf("1e-2"), mp.mpf("1e-3"):
        limit = long_wave_vortex(20, k)
        error.append(abs(vortex(20, 0.7, k, limit) / limit - 1))
    assert error[1] < 1e-6
    assert abs(error[0] / error[1] - 100) < 0.1


@pytest.mark.parametrize(("depth", "order"), [(mp.inf, mp.mpf(2) / 3), (5, 1)])
def test_dune_long_waves(depth, order):
    error = []
    for k in mp.mpf("1e-5"), mp.mpf("1e-6"):
        limit = long_wave_dune(2, 1, wall_response(k, 10, depth), k)
        error.append(abs(dune(2, 0.4, 1, 10, depth, k, limit) / limit - 1))
    assert abs(mp.log10(error[0] / error[1]) - order) < 0.01


@pytest.mark.parametrize("seed", range(4))
def test_vortex_digits(seed):
    draw = random.Random(seed)
    flow = draw.uniform(5, 45), 10 ** draw.uniform(-3, -1.5)
    k = 10 ** draw.uniform(-1, 1.477)

    def solve(k, guess, **how):
        return vortex(*flow, k, guess, **how)

    sigma = followed(solve, lambda k: long_wave_vortex(flow[0], k), k)
    assert agree(solve(k, sigma), solve(k, sigma, digits=45), 30)


@pytest.mark.parametrize("seed", range(4))
def test_dune_digits(seed):
    draw = random.Random(seed)
    shields, mu1, b = draw.uniform(1.05, 4), draw.uniform(0.2, 0.7), 10 ** draw.uniform(-0.5, 0.5)
    Re, depth = 10 ** draw.uniform(-1.3, 3.5), draw.choice([mp.inf, draw.uniform(2, 20)])
    k = 10 ** draw.uniform(-1, 0.9)

    def solve(k, guess, **how):
        return dune(shields, mu1, b, Re, depth, k, guess, **how)

    sigma = followed(solve, lambda k: long_wave_dune(shields, b, wall_response(k, Re, depth), k), k)
    assert agree(solve(k, sigma), solve(k, sigma, digits=45), 30)


def speeds():
    """(flow, Re, k, real part of c, imaginary part) of plane Poiseuille and Couette flow, as printed."""
    modes = [("poiseuille", 10000, 1, row["c_r"], row["c_i"]) for row in table("recomputed_poiseuille")]
    return modes + [(row["flow"], int(float(row["Re"])), 1, row["c_r"], row["c_i"])
                    for row in table("recomputed_shear_flows")]


@pytest.mark.parametrize(("flow", "Re", "k", "real", "imag"), speeds())
def test_plane_flows(flow, Re, k, real, imag):
    solve = getattr(references, flow)
    with mp.workdps(30):
        sigma = -1j * mp.mpc(real, imag)
        c = 1j * solve(Re, k, sigma, digits=24)
        for part, printed in (c.real, real), (c.imag, imag):
            assert abs(part - mp.mpf(printed)) <= mp.mpf(10) ** -len(printed.partition(".")[2])
    assert not agree(solve(1.01 * Re, k, sigma, digits=10, radius=0.1), sigma, 5)


def test_poiseuille_critical_point():
    with mp.workdps(30):
        Re, k, c = (mp.mpf(row["value"]) for row in table("recomputed_poiseuille_critical"))
        found = 1j * poiseuille(Re, k, -1j * k * c) / k
        assert abs(found.imag) < 1e-22
        assert agree(found.real, c, 23)


def slow_growth(solve, k):
    """Growth rate over k^2 of a mode that is neutral as k -> 0, and the relative size of the next term."""
    return [solve(k * factor).real / (k * factor)**2 for factor in (1, mp.mpf(1) / 2)]


@pytest.mark.parametrize("slope", [30, 90, 120])
def test_film_long_waves(slope):
    """sigma = -2 i k + (8/15)(Re - (5/4) cot slope) k^2 + O(k^3), Yih (1963)."""
    with mp.workdps(30):
        Re = mp.mpf(7)
        exact = mp.mpf(8) / 15 * (Re - mp.mpf(5) / 4 * mp.cot(mp.radians(slope)))
        coarse, fine = slow_growth(lambda k: film(Re, slope, 0.3, k, -2j * k), mp.mpf("1e-5"))
        assert agree(fine, exact, 8)
        assert abs((coarse - exact) / (fine - exact) - 4) < 1e-3


def test_film_capillary_waves():
    """Short waves on deep liquid without inertia decay at the rate k We Re/2 of Stokes flow, seen from the surface."""
    k, Re, We = 20, mp.mpf("1e-8"), mp.mpf("1e6")
    sigma = film(Re, 90, We, k, -1j * k - k * We * Re / 2, radius=0.1)
    assert agree(sigma.real, -k * We * Re / 2, 5)


def test_roll_wave_thresholds():
    """The k^2 of the growth rate vanishes at Fr2 = 4 - 6 t^2 + 3 e0 t, t = tan(slope)."""
    with mp.workdps(30):
        t, low, high, k = mp.tan(mp.radians(28)), mp.mpf("0.3819"), mp.mpf("0.6435"), mp.mpf("1e-6")
        e0 = (high - t) * (t - low) / (high - low)
        threshold = 4 - 6 * t**2 + 3 * e0 * t

        def growth(F):
            return rollwave(28, F, low, high, k, -1j * k).real / k**2

        expected = ((mp.mpf("1.2") / 10 - mp.mpf(2) / 5 + mp.mpf(3) / 5 * t**2) / e0 - mp.mpf(3) / 10 * t)
        assert agree(growth(mp.mpf("1.2")), expected, 8)
        assert abs(growth(threshold)) < 1e-8 * abs(expected)


def yih(m, n):
    return 2 * m * n**2 * (m - 1) * (n + 1) / ((m + n) * (m**2 + 4 * m * n**3 + 6 * m * n**2 + 4 * m * n + n**4))


def test_two_layer_long_waves():
    """c relative to the interface as k -> 0, Yih (1967), and for equal depths the next term."""
    with mp.workdps(30):
        k, Re = mp.mpf("1e-5"), mp.mpf(30)
        for m, n in (mp.mpf(3), mp.mpf(1)), (mp.mpf("0.2"), mp.mpf("1.7")):
            limit = -1j * k * (n / (m + n) + yih(m, n))
            sigma = two_layer_couette(m, n, 1, Re, 0, 0, k, limit)
            assert agree(sigma.imag, limit.imag, 8)
            if n == 1:
                growth = Re * (m - 1)**4 * (5 * m**2 + 6 * m + 5) / (60 * (m + 1) * (m**2 + 14 * m + 1)**3)
                assert agree(sigma.real / k**2, growth, 8)


def test_two_layers_of_one_liquid_are_couette_flow():
    """Equal liquids: modes of plane Couette flow in other scales, U = (1 + z)/2 and depth 2, Re four times larger."""
    with mp.workdps(30):
        k, Re = mp.mpf(1), 100
        expected = couette(Re, k, -0.2904098 + 0.2073979j)
        found = two_layer_couette(1, 1, 1, 2 * Re, 0, 0, k, expected / 2 - mp.mpc(0, "0.5"))
        assert agree(found, expected / 2 - mp.mpc(0, "0.5"), 25)


def test_interface_under_gravity_in_stokes_flow():
    """Rayleigh-Taylor of deep liquids of equal viscosity: growth (density difference) gravity Re/(4 k)."""
    k, Re, g = 20, mp.mpf("1e-7"), mp.mpf("1e7")
    sigma = two_layer_couette(1, 1, 0.5, Re, g, 0, k, 0.5 * g * Re / (4 * k) - 0.5j * k, radius=0.1)
    assert agree(sigma.real, mp.mpf("0.5") * g * Re / (4 * k), 5)


@pytest.mark.parametrize("solve", [
    lambda **how: rollwave(29, 30, 0.38, 0.65, 3, -0.03005506 - 2.15086659j, **how),
    lambda **how: film(80, 100, 0.2, 2, -0.07901272 - 3.05998484j, **how),
    lambda **how: couette(300, 2, -0.32260034 - 1.12003044j, **how),
    lambda **how: two_layer_couette(3, 0.5, 1.2, 100, 0.7, 0.3, 5, -0.634537 + 2.83175j, **how),
])
def test_digits(solve):
    assert agree(solve(), solve(digits=45), 30)


def test_what_takes_too_long_is_refused():
    with pytest.raises(ArithmeticError, match="bits|terms"):
        poiseuille(1e9, 1, -0.01 - 0.01j)
