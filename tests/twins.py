"""Flows with one coefficient wrong by 1 %, to show that a test can fail; and the published tables."""

import csv
from dataclasses import dataclass, fields, replace
from pathlib import Path
from types import SimpleNamespace

TABLES = Path(__file__).parent / "tables"


def table(name):
    """The rows of a table as dicts of strings, its comments left out."""
    with open(TABLES / f"{name}.csv", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def wrong_coefficient(flow, name):
    """The flow with the coefficient `name` of its base flow 1 % too large."""

    @dataclass(frozen=True)
    class Wrong(type(flow)):
        def layers(self, names):
            return tuple(replace(layer, profile=_spoiled(layer.profile, name)) for layer in super().layers(names))

    Wrong.__module__ = type(flow).__module__  # a flow from elsewhere is compared with its own series: too early here
    return Wrong(**_parameters(flow))


def wrong_condition(flow, index):
    """The flow with the displacement of the surface 1 % too large in one condition."""

    @dataclass(frozen=True)
    class Wrong(type(flow)):
        def conditions(self, edges, names):
            right = list(super().conditions(edges, names))
            spoiled = SimpleNamespace(**{**vars(names), "s0": 1.01 * names.s0})
            right[index] = super().conditions(edges, spoiled)[index]
            return tuple(right)

    Wrong.__module__ = type(flow).__module__
    return Wrong(**_parameters(flow))


def _spoiled(profile, name):
    def spoiled(s):
        base = profile(s)
        return replace(base, **{name: 1.01 * getattr(base, name)})

    return spoiled


def _parameters(flow):
    return {item.name: getattr(flow, item.name) for item in fields(flow)}
