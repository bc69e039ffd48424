"""Friction laws as values: their mathematics, their parameters as parameters of flows, and what is refused."""

import pickle
from dataclasses import dataclass, fields, replace
from math import inf, radians, tan
from typing import ClassVar

import numpy as np
import pytest

from stability import dispersion, flows
from stability.cli import main
from stability.errors import ParameterError
from stability.flows import Dune, Law, Linear, PowerLaw, Regularised, RollWave, Saturating, parameter
from stability.flows.rheology import law_condition

SLOPES = tan(radians(20.9)), tan(radians(32.76))
LAWS = (Linear(0.4, 1.3), Saturating(*SLOPES, 0.279), PowerLaw(0.4, 0.7, 0.6), Regularised(*SLOPES, 0.279))


@dataclass(frozen=True)
class Root(Law):
    """mu1 sqrt(1 + c I): derivative and inverse are left to follow."""

    name: ClassVar[str] = "root"
    mu1: float = parameter(0.4, 0, meaning="friction at rest")
    c: float = parameter(2.0, 0, meaning="rate coefficient")

    def mu(self, I):  # noqa: E741
        return self.mu1 * np.sqrt(1 + self.c * I)


@dataclass(frozen=True)
class OwnSaturating(Law):
    name: ClassVar[str] = "own"
    mu1: float = parameter(0.4, 0, meaning="friction at rest")
    mu2: float = parameter(0.6, 0, meaning="friction of rapid flow")
    I0: float = parameter(0.3, 0, meaning="inertial number")

    def mu(self, I):  # noqa: E741
        return self.mu1 + (self.mu2 - self.mu1) / (1 + self.I0 / I)


@pytest.mark.parametrize("law", [*LAWS, Root()], ids=lambda law: law.name)
def test_slope_and_inverse_belong_to_mu(law):
    inertia = np.geomspace(1e-3, 5, 31)
    np.testing.assert_allclose(law.inverse(law.mu(inertia)), inertia, rtol=2e-13 / law.mu(1e-3) * 10)
    step = 1e-4 * inertia
    difference = (law.mu(inertia + step) - law.mu(inertia - step)) / (2 * step)
    np.testing.assert_allclose(law.slope(inertia), difference, rtol=1e-7)
    assert law.start <= law.mu(1e-9) < law.mu(1e3) < law.range[1]


def test_the_regularised_law_has_the_published_join():
    for (mu1, mu2, I0), I1, A in (((*SLOPES, 0.279), 0.0191686, 2967.676),
                                  ((0.342, 0.557, 0.069), 0.00396281, 15640.68)):
        law = Regularised(mu1, mu2, I0, alpha=1.9, mu_inf=0.05)
        assert pytest.approx(I1, abs=6e-8 if I1 > 0.01 else 6e-9) == law.I1
        assert pytest.approx(A, abs=6e-3 if I1 < 0.01 else 6e-4, rel=3e-7) == law.A
        assert law.mu(law.I1 * (1 - 1e-13)) == pytest.approx(law.mu(law.I1), rel=1e-12)
        slow = np.geomspace(1e-8, 0.999, 30) * law.I1
        assert (law_condition(law, slow) < 0).all()
        assert (law_condition(law, np.geomspace(1.001 * law.I1, 10, 30)) < 0).all()


def test_a_saturating_law_with_large_I0_tends_to_the_linear_one():
    """mu is mu1 (1 + b I) - O(I^2 / I0) at fixed (mu2 - mu1)/(mu1 I0) = b: the difference falls like 1/I0."""
    bed = Dune(shields=1.8, mu1=0.4, b=1.2)
    exact = dispersion(bed, 1.0).modes[0].sigma
    off = [abs(dispersion(bed.with_law(Saturating(0.4, 0.4 + 0.4 * 1.2 * I0, I0)), 1.0).modes[0].sigma - exact)
           for I0 in (1e2, 1e3, 1e4, 1e5)]
    np.testing.assert_allclose(-np.diff(np.log10(off)), 1, atol=0.02)


@pytest.mark.parametrize("k", [0.01, 1.0, 5.0])
def test_laws_that_are_the_same_give_the_same(k):
    """PowerLaw at n = 1 goes through quadrature, Linear is closed: equal within both error bars. So are own laws."""
    pairs = ((Dune(), Dune(law=PowerLaw(0.4, 1.0, 1.0))),
             (Dune(shields=1.4, law=Saturating(0.4, 0.6, 0.3)), Dune(shields=1.4, law=OwnSaturating())),
             (RollWave(), RollWave(law=Saturating())), (RollWave(), RollWave(law=OwnSaturating(*SLOPES))))
    for one, other in pairs:
        first, second = (dispersion(flow, k).modes[0] for flow in (one, other))
        assert abs(first.sigma - second.sigma) <= 3 * (first.error + second.error)


def test_flows_with_laws_are_values():
    flow = Dune(shields=1.4, law=Saturating(mu1=0.4, mu2=0.6, I0=0.3))
    assert flow == Dune(1.4, law=Saturating(mu1=0.4, mu2=0.6, I0=0.3))
    assert hash(flow) == hash(replace(flow))
    assert pickle.loads(pickle.dumps(flow)) == flow
    assert replace(flow, mu2=0.7).law == Saturating(0.4, 0.7, 0.3)
    assert isinstance(flow, Dune)
    assert {item.name for item in fields(flow)} == {"shields", "mu1", "mu2", "I0", "Re", "depth", "fluid"}
    assert flow.stated()["law"] == "saturating"
    assert "law" not in flows.Dune().stated()
    assert Dune(law=Linear(0.4, 1.0)) == Dune()
    assert flow.with_law(Linear(0.4, 1.0)) == Dune(shields=1.4)
    assert repr(Dune()) == "Dune(shields=2.0, mu1=0.4, b=1.0, Re=10.0, depth=inf, fluid='closed-form')"


def test_parameters_of_laws_have_sensitivities():
    flow, k = Dune(shields=1.4, law=Saturating(0.4, 0.6, 0.3)), 1.0
    slopes = dispersion(flow, k).modes[0].sensitivity()
    for name in ("mu1", "mu2", "I0", "shields"):
        value = getattr(flow, name)
        step = 1e-4 * value
        ahead, behind = (dispersion(replace(flow, **{name: value + sign * step}), k).modes[0].sigma for sign in (1, -1))
        assert slopes[name] == pytest.approx((ahead - behind) / (2 * step), rel=1e-5)


@pytest.mark.parametrize("flow", [
    Dune(shields=1.4, law=Saturating(0.4, 0.6, 0.3)),
    Dune(shields=1.3, law=Saturating(0.3, 0.5, 0.1), Re=300.0, depth=4.0),
    Dune(shields=1.5, law=Regularised(0.4, 0.6, 0.3)), Dune(shields=1.02, law=Regularised(0.4, 0.6, 0.3), depth=10.0),
    Dune(shields=2.5, law=Root())], ids=str)
def test_long_waves_of_dunes_under_any_law(flow):
    """The difference from i k shields dQ/d(shields) R falls faster than the limit, by its next power k^(2/3) or k."""
    k = np.array([1e-6, 1e-8])
    found = dispersion(flow, k)
    off = np.abs(found.sigma / flow.long_wave(k) - 1)
    order = np.log10(off[0] / off[1]) / 2
    assert order == pytest.approx(1.0 if flow.depth < inf else 2 / 3, abs=0.05)
    assert off[1] < 1e-4 < np.abs(found.sigma[1] / (1.01 * flow.long_wave(k[1])) - 1)  # a limit 1 % off fails


@pytest.mark.parametrize(("make", "message"), [
    (lambda: Dune(shields=2, law=Saturating(0.4, 0.6, 0.3)), r"shields must lie in \(1, 1.5\)"),
    (lambda: Dune(b=2.0, law=Saturating(0.4, 0.6, 0.3)), "b belongs to the friction law"),
    (lambda: Dune(mu1=0.3, law=Saturating(0.4, 0.6, 0.3)), "mu1 belongs to the friction law"),
    (lambda: Dune(law=Saturating), r"did you mean Saturating\(\)"),
    (lambda: Dune(law=PowerLaw(0.4, 1.0, 0.5)), "must rise linearly"),
    (lambda: RollWave(slope_deg=35, law=Saturating()), "slope_deg must lie between"),
    (lambda: replace(Dune(shields=1.4, law=Saturating(0.4, 0.6, 0.3)), mu2=0.3), "mu2 must exceed mu1"),
    (lambda: Regularised(alpha=2.5), "from 2 on slow flow is ill posed"),
    (lambda: Regularised(mu1=1.2, mu2=1.3), "nothing to join"),
])
def test_refusals(make, message):
    with pytest.raises(ParameterError, match=message):
        make()


def test_a_law_of_ones_own_that_contradicts_itself_is_refused():
    class Wrong(Root):
        name = "wrong"

        def slope(self, I):  # noqa: E741
            return 1.01 * super().slope(I)

    class Backwards(Root):
        name = "backwards"

        def inverse(self, mu):
            return 1.01 * super().inverse(mu)

    class Falling(Root):
        name = "falling"

        def mu(self, I):  # noqa: E741
            return self.mu1 / (1 + I)

    class Short(OwnSaturating):
        name = "short"

        @property
        def range(self):
            return self.mu1, self.mu2

        def between(self, excess, lack):
            return 1.01 * self.I0 * excess / lack

    for law, message in ((Wrong, r"wrong: slope\(I\) contradicts mu\(I\)"), (Falling, "must rise with I"),
                         (Backwards, r"backwards: inverse\(mu\) contradicts mu\(I\)"),
                         (Short, r"short: between\(excess, lack\) contradicts mu\(I\)")):
        with pytest.raises(ParameterError, match=message):
            law()


LAW_FILE = '''
from dataclasses import dataclass
from typing import ClassVar
import numpy as np
from stability.flows import Law, parameter

@dataclass(frozen=True)
class Root(Law):
    name: ClassVar[str] = "root"
    mu1: float = parameter(0.4, 0, meaning="friction at rest")
    c: float = parameter(2.0, 0, meaning="rate coefficient")

    def mu(self, I):
        return self.mu1 * np.sqrt(1 + self.c * I)
'''


def test_laws_on_the_command_line(capsys, tmp_path):
    file = tmp_path / "law.py"
    file.write_text(LAW_FILE)
    for words, expected in (
            (["--shields", "1.4", "--law", "saturating", "--mu2", "0.6", "--I0", "0.3"], "# law: saturating"),
            (["--law", f"{file}:Root", "--c", "3"], "# law_source: law.py:Root"), ([], "# b: 1.0")):
        assert main(["dispersion", "dune", "--k", "1", "--csv", *words]) == 0
        assert expected in capsys.readouterr().out
    assert main(["kmax", "dune", "--shields", "1.3", "--law=saturating", "--over", "mu2=0.6,0.65",
                 "--mode", "surface"]) == 0
    assert capsys.readouterr().out.count("resolved") == 2
    for words, expected in ((["--law", "saturating", "--b", "2"], "unknown option '--b'"),
                            (["--law", "satrating"], "did you mean 'saturating'"),
                            (["--mu2", "0.6"], "unknown option '--mu2'")):
        assert main(["dispersion", "dune", "--k", "1", *words]) == 2
        assert expected in capsys.readouterr().err


def test_vortices_take_no_law():
    with pytest.raises(TypeError):
        flows.Vortex(law=Saturating())


def test_numbers_of_another_law_are_not_checked_against_the_expansion(capsys, tmp_path):
    from asymptotics.cli import main as check

    file = tmp_path / "power.csv"
    assert main(["dispersion", "dune", "--law", "power", "--k", "1e-5:1e-3:5", "-o", str(file)]) == 0
    assert check(["check", "dune", str(file)]) == 2
    assert "holds friction law power" in capsys.readouterr().err
