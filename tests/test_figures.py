"""The laws that the first figure draws beside the computed curves; the index of figures, and the citation."""

import re
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from stability import flows
from stability.studies.kmax import k_max_sweep

FIGURES = Path(__file__).parents[1] / "figures"


@pytest.fixture
def figure(monkeypatch):
    """The script figures/k_max.py as a module."""
    monkeypatch.syspath_prepend(str(FIGURES))
    import k_max

    yield k_max
    for name in ("k_max", "style"):
        del sys.modules[name]


def remainders(law, bed, Re):
    """Relative differences (quantities, Re) of k_max and its growth rate from a law."""
    found = k_max_sweep(replace(bed, Re=value) for value in Re)
    return np.array([[optimum.k_max, optimum.growth_rate] for optimum in found]).T / np.array(law(np.array(Re))) - 1


@pytest.mark.parametrize("bed", [flows.Dune(), flows.Dune(shields=3.0)], ids=["shields 2", "shields 3"])
def test_large_Re(figure, bed):
    """k_max ~ Re^(1/8), growth ~ Re^(1/4), with the coefficients of the half-space and a remainder ~ Re^(-1/8)."""
    near, far = remainders(figure.large_Re(bed), bed, [1e12, 1e16]).T
    assert np.all(np.abs(far) < 0.01)
    np.testing.assert_allclose(np.log10(near / far), 4 / 8, atol=0.1)


def test_small_Re(figure):
    """k_max ~ Re^(1/2), growth ~ Re, with a remainder that falls at least like Re^(1/2)."""
    near, far = remainders(figure.small_Re(flows.Dune()), flows.Dune(), [1e-4, 1e-6]).T
    assert np.all(np.abs(far) < 1e-3)
    assert np.all(np.log10(near / far) > 0.9)


def test_every_figure_is_in_the_index():
    """With a thumbnail and its script, and with both files beside it."""
    index = (FIGURES / "README.md").read_text(encoding="utf-8")
    scripts = sorted(path.stem for path in FIGURES.glob("*.py") if path.name not in {"all.py", "style.py"})
    assert sorted(re.findall(r'<img src="(\w+)\.png" width="\d+">', index)) == scripts
    assert sorted(re.findall(r"\[\w+\.py\]\((\w+)\.py\)", index)) == scripts
    assert all((FIGURES / name).with_suffix(ending).exists() for name in scripts for ending in (".png", ".csv"))


def test_the_citation_has_the_version_and_the_authors_of_the_package():
    citation = (FIGURES.parent / "CITATION.cff").read_text(encoding="utf-8")
    project = tomllib.loads((FIGURES.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert f"\nversion: {project['version']}\n" in citation
    assert f"\n  - name: {project['authors'][0]['name']}\n" in citation
