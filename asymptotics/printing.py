"""Expansions as text: a table that explains its symbols, LaTeX with the symbols of print, JSON, and numbers over k."""

import csv
import io
import json
from typing import Any

import numpy as np
import sympy as sp

from . import __version__
from .series import Expansion

_COLUMNS = ("k", "growth_rate", "phase_speed", "error", "group_speed", "group_error", "degree", "status")
"""As `stability dispersion` has them."""
_FUNCTIONS = {
    "gamma": "the gamma function", "log": "the natural logarithm",
    "WallResponse": "response of the fluid's shear stress to a wavy wall of unit amplitude, Psi''(0)/s0 of "
                    "(4.59)-(4.63), at wavenumber, Reynolds number and depth",
}


def table(expansion: Expansion, meanings: dict[str, str]) -> str:
    """Power, value and coefficient of each term, then what every symbol in them stands for."""
    values = expansion.values()
    cells = [("power", "value", "coefficient")]
    for power, c in expansion.terms.items():
        value = values[power]
        cells.append((str(power), "-" if value is None else f"{value.real:+.12e} {value.imag:+.12e}i", str(c)))
    widths = [max(len(row[column]) for row in cells) for column in range(2)]
    lines = [f"{power.rjust(widths[0])}  {value.ljust(widths[1])}  {c}" for power, value, c in cells]
    return "\n".join([*lines, "", *_explained(expansion, meanings)])


def _explained(expansion: Expansion, meanings: dict[str, str]) -> list[str]:
    """A line for the sum, and for each symbol and function in the coefficients."""
    gauge, coefficients = expansion.gauge, list(expansion.terms.values())
    of = "" if expansion.wavenumber == gauge else f", at the wavenumber k = {expansion.wavenumber}"
    lines = [f"sigma = sum of coefficient * {gauge}^power: complex growth rate{of}"]
    names = {symbol.name for c in coefficients for symbol in c.free_symbols} | {gauge.name}
    known = {"delta": "small parameter", **meanings, "k": "wavenumber"}
    lines += [f"{name}: {known[name]}" for name in sorted(names, key=str.lower) if name in known]
    applied = sorted({f for c in coefficients for f in c.atoms(sp.Function) if type(f).__name__ in _FUNCTIONS}, key=str)
    told = set()
    for one in applied:
        kind = type(one).__name__
        if kind == "WallResponse" or kind not in told:
            name = str(one) if kind == "WallResponse" else kind
            lines.append(f"{name}: {_FUNCTIONS[kind]}")
        told.add(kind)
    if any(c.has(sp.oo) for c in coefficients):
        lines.append("oo: infinity, an unbounded fluid")
    if any(c.has(sp.I) for c in coefficients):
        lines.append("I: imaginary unit")
    return lines


def latex(expansion: Expansion, symbols: dict[str, str]) -> str:
    """The terms in LaTeX, parameters as they are printed; angles are no longer in degrees."""
    terms = {power: _printed(c, symbols) for power, c in expansion.terms.items()}
    free = {symbol for c in (*terms.values(), expansion.gauge) for symbol in c.free_symbols}
    names = {symbol: symbols[symbol.name] for symbol in free if symbol.name in symbols}
    lines = [rf"\sigma_{{{sp.latex(power)}}} &= {sp.latex(c, symbol_names=names)}" for power, c in terms.items()]
    gauge = sp.latex(expansion.gauge, symbol_names=names)
    return "\n".join([rf"% \sigma = \sum_p \sigma_p {gauge}^p", *(line + r" \\" for line in lines)])


def _printed(c: Any, symbols: dict[str, str]) -> Any:
    """A coefficient with the angle itself in trigonometric functions, not its degrees, and Fr^2 as a square."""
    changed = {}
    for symbol in c.free_symbols:
        angle, root = (sp.Symbol(symbol.name.removesuffix(end), positive=True) for end in ("_deg", "2"))
        if symbol.name.endswith("_deg") and angle.name in symbols:
            changed[symbol] = 180 * angle / sp.pi
        elif symbol.name.endswith("2") and symbol.name not in symbols and root.name in symbols:
            changed[symbol] = root**2
    return c.subs(changed)


def as_json(expansion: Expansion) -> str:
    values = expansion.values()
    terms = [{"power": str(power), "coefficient": str(c), "value": _pair(values[power])}
             for power, c in expansion.terms.items()]
    record = {
        "flow": expansion.flow,
        "regime": expansion.regime,
        "gauge": str(expansion.gauge),
        "parameters": {name: _plain(value) for name, value in expansion.parameters.items()},
        "terms": terms,
        "growth_rate": str(expansion.growth_rate),
        "phase_speed": str(expansion.phase_speed),
    }
    return json.dumps(record, indent=1, allow_nan=False)


def _pair(value: complex | None) -> list[float] | None:
    return None if value is None else [value.real, value.imag]


def _plain(value: Any) -> Any:
    """A JSON number; infinity, which JSON lacks, as the string that the command line takes."""
    if value is None:
        return None
    return float(value) if value.is_finite else "inf"


# -- numbers ---------------------------------------------------------------------------------------------


def numbers(expansion: Expansion, k: np.ndarray, form: str | None) -> str:
    """The series at wavenumbers k in the columns of `stability dispersion`: without error bars, for it has none."""
    highest = max(power for power, c in expansion.terms.items() if c != 0)
    status = f"series to k^{highest}; error O(k^{expansion.next_power})"
    sigma, slope = (series.function()(k).tolist() for series in (expansion, expansion.derivative()))
    rows = [dict(zip(_COLUMNS, (one, here.real, -here.imag / one + 0.0, None, -steep.imag + 0.0, None, None, status),
                     strict=True)) for one, here, steep in zip(k.tolist(), sigma, slope, strict=True)]
    parameters = {name: float(value) if value is not None else None for name, value in expansion.parameters.items()}
    header = {"flow": expansion.flow, "method": "expansion", "version": __version__}
    about = {"regime": expansion.regime, "order": str(highest)}
    if form == "json":
        shown = {name: str(value) if value == float("inf") else value for name, value in parameters.items()}
        return json.dumps({"flow": header["flow"], "parameters": shown, "method": "expansion", "version": __version__,
                           **about, "rows": rows}, indent=1, allow_nan=False)
    if form == "csv":
        return _csv({**header, **parameters, **about}, rows)
    return _columns(rows)


def _csv(header: dict[str, Any], rows: list[dict[str, Any]]) -> str:
    text = io.StringIO()
    text.writelines(f"# {key}: {value}\n" for key, value in header.items())
    writer = csv.DictWriter(text, _COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().rstrip("\n")


def _columns(rows: list[dict[str, Any]]) -> str:
    cells = [_COLUMNS, *(tuple("-" if value is None else f"{value:.10g}" if isinstance(value, float) else str(value)
                               for value in row.values()) for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join("  ".join(cell.rjust(width) if place < len(widths) - 1 else cell
                               for place, (cell, width) in enumerate(zip(row, widths, strict=True))) for row in cells)
