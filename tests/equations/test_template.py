"""Coefficients of the equations from products that were written out once: those of the equations themselves."""

import numpy as np
import pytest

from stability.equations.forms import variable
from stability.equations.layer import FIELDS, Profile, residuals
from stability.equations.template import coefficients

NAMES = "dz", "eta", "beta", "rho", "U", "dU", "alpha", "g", "dg", "clear"


def written_out(base, order, steady):
    """{(equation, unknown, other symbols): coefficient} of the residuals, but for those that are 0 everywhere."""
    slopes = [f"{name}'" for name in FIELDS]
    forms = residuals(base, variable("k"), 0.0 if steady else variable("rate"), list(map(variable, FIELDS)),
                      list(map(variable, slopes)), order)
    found = {}
    for equation, form in enumerate(forms):
        for names, value in form.terms.items():
            (unknown,) = set(names) & {*FIELDS, *slopes}
            if np.any(value):
                found[equation, unknown, tuple(sorted(name for name in names if name != unknown))] = value
    return found


@pytest.mark.parametrize("steady", [False, True])
@pytest.mark.parametrize("order", [0, 1])
@pytest.mark.parametrize("lacking", [(), ("alpha", "U", "dU"), ("rho",), NAMES[3:-1], ("height",)], ids=str)
def test_coefficients_are_those_of_the_equations(order, steady, lacking):
    """Of profiles with numbers and arrays, without some of what they have, and of a height that depends on k."""
    rng = np.random.default_rng(5)
    values = {name: rng.uniform(0.5, 2.0, 7) if number % 2 else float(rng.uniform(0.5, 2.0))
              for number, name in enumerate(NAMES)} | {name: 0.0 for name in lacking if name in NAMES}
    if "height" in lacking:
        values["dz"] = 2.5 * variable("H") + values["dz"]
    base = Profile(**values)
    ours, theirs = coefficients(base, order, steady), written_out(base, order, steady)
    assert ours.keys() == theirs.keys()
    for key, value in ours.items():
        np.testing.assert_allclose(value, theirs[key], rtol=1e-14)


def test_a_profile_without_resistance_has_coefficients_that_are_not_finite():
    with np.errstate(divide="ignore"):
        found = coefficients(Profile(dz=1.0, eta=1.0, beta=0.0), 0, False)
    assert not all(np.isfinite(value) for value in found.values())
