"""What every column of every result means, and its units: for the help of the verbs, netCDF files and the reference.

Every flow is dimensionless in scales of its own, L of length, V of velocity and S of stress, which
`stability flows FLOW` lists; sigma and the shear rate are in V/L. Imports nothing: help needs no numerics.

>>> print(column("growth_rate"))
real part of the complex growth rate sigma, positive where waves grow [V/L]
>>> column("error", "kmax").meaning
'bound of the absolute error of k_max'
"""

from typing import NamedTuple

SCALES = "L, V, S: scales of length, velocity and stress (stability flows FLOW); 1: a number"
PARAMETERS = "NAME"  # stands for the column of a parameter of the flow
ANY_DEGREE = "degree_N"  # stands for degree_16, degree_24 ...


class Column(NamedTuple):
    """Meaning of a column and its units, "" for text."""

    meaning: str
    units: str

    def __str__(self) -> str:
        return f"{self.meaning} [{self.units}]" if self.units else self.meaning


_PARAMETER = "of the parameter"
_SIGMA_PER = "V/L over the parameter's"
COLUMNS = {
    "k": Column("wavenumber", "1/L"),
    "growth_rate": Column("real part of the complex growth rate sigma, positive where waves grow", "V/L"),
    "phase_speed": Column("real part of the complex wave speed i sigma / k, positive downstream", "V"),
    "group_speed": Column("real part of the group velocity i d sigma/dk, positive downstream", "V"),
    "group_error": Column("bound of the absolute error of group_speed", "V"),
    "sigma": Column("complex growth rate", "V/L"),
    "slope": Column("derivative of sigma with respect to k", "V"),
    "frequency": Column("imaginary part of sigma", "V/L"),
    "degree": Column("Chebyshev degree of the series in each layer", "1"),
    "nodes": Column("nodes of the mesh of solve_bvp", "1"),
    "condition": Column("condition number of the eigenvalue in the energy norm", "1"),
    "status": Column("resolved, or what failed", ""),
    "k_max": Column("wavenumber of the largest growth rate", "1/L"),
    "k_error": Column("bound of the absolute error of k", "1/L"),
    "growth_error": Column("bound of the absolute error of sigma", "V/L"),
    "growth_data_error": Column("standard error of the growth rate from the errors of the measured base flow", "V/L"),
    "second_k_max": Column("wavenumber of the second largest maximum of the growth rate", "1/L"),
    "second_growth_rate": Column("growth rate of the second largest maximum", "V/L"),
    "maxima_k": Column("wavenumbers of all local maxima of the growth rate", "1/L"),
    "maxima_growth_rate": Column("growth rates of all local maxima", "V/L"),
    "parameter": Column("parameter of the flow, or k", ""),
    "value": Column("value of the parameter", _PARAMETER),
    "d_growth_rate": Column("derivative of the growth rate with respect to the parameter", _SIGMA_PER),
    "d_phase_speed": Column("derivative of the phase speed with respect to the parameter", "V over the parameter's"),
    "elasticity": Column("relative change of the growth rate per relative change of the parameter", "1"),
    "layer": Column("layer of the flow, from below", ""),
    "z": Column("height", "L"),
    "U": Column("velocity of the base flow", "V"),
    "dU": Column("shear rate of the base flow, dU/dz", "V/L"),
    "shear_stress": Column("shear stress of the base flow", "S"),
    "viscosity": Column("shear stress over shear rate", "S L/V"),
    "tangent_viscosity": Column("derivative of the shear stress with respect to the shear rate", "S L/V"),
    "pressure": Column("pressure of the base flow", "S"),
    "inertial_number": Column("inertial number of the base flow", "see the notes of the flow"),
    "angular_velocity": Column("angular velocity of the base flow", "V/L"),
    "method": Column("method of computation", ""),
    "setting": Column("its resolution or tolerance", ""),
    "reported": Column("error that the method itself reports", "V/L"),
    "seconds": Column("CPU time per eigenvalue", "s"),
    "unknowns": Column("unknowns of the discrete problem", "1"),
    "height": Column("height above the lower edge of the layer", "L"),
    "C": Column("discriminant of the friction law: ill posed where positive", "1"),
    "short_waves": Column("growth rate of the shortest waves over k^2", "V L"),
    "ill_posed": Column("yes where short waves grow without bound", ""),
    "surface_mode": Column("growth rate of the slow surface mode", "V/L"),
    ANY_DEGREE: Column("largest growth rate of all modes at Chebyshev degree N", "V/L"),
}

_VARYING = "error", "data_error", "maxima"  # what they mean depends on the verb
_ERRORS = {"sigma": "V/L", "k_max": "1/L", "dU": "V/L", "the derivative of sigma": _SIGMA_PER}  # what: units
_LIST_OF_MAXIMA = Column("all local maxima, (wavenumber, growth rate) each", "1/L, V/L")
_NUMBER_OF_MAXIMA = Column("number of local maxima of the growth rate", "1")

# The columns of each verb, in their order as far as it is one.
BY_VERB = {
    "base": ("layer", "z", "U", "dU", "shear_stress", "viscosity", "tangent_viscosity", "pressure", "inertial_number",
             "angular_velocity", "error", "status"),
    "spectrum": ("k", "growth_rate", "phase_speed", "error", "data_error", "degree", "condition", "status"),
    "dispersion": (PARAMETERS, "k", "growth_rate", "phase_speed", "error", "group_speed", "group_error", "data_error",
                   "degree", "nodes", "status"),
    "kmax": (PARAMETERS, "k_max", "growth_rate", "phase_speed", "error", "data_error", "growth_data_error", "maxima",
             "status"),
    "neutral": (PARAMETERS, "k", "phase_speed", "error", "data_error", "status"),
    "critical": ("k", PARAMETERS, "phase_speed", "error", "data_error", "k_error", "status"),
    "map": (PARAMETERS, "k", "k_max", "growth_rate", "phase_speed", "error", "data_error", "growth_data_error",
            "growth_error", "k_error", "degree", "maxima", "second_k_max", "second_growth_rate", "status"),
    "sensitivity": ("parameter", "value", "d_growth_rate", "d_phase_speed", "elasticity", "error", "status"),
    "compare": ("method", "setting", "growth_rate", "frequency", "error", "reported", "seconds", "unknowns", "status"),
    "wellposed": ("layer", "height", "C", "short_waves", "ill_posed", "k", "surface_mode", ANY_DEGREE, "status"),
}
_BOUNDED = {"base": "dU", "kmax": "k_max", "sensitivity": "the derivative of sigma",
            "neutral": "the parameter solved for", "critical": "the parameter solved for",
            "map": "k_max or sigma, or of the parameter solved for"}
_PARAMETER_OF = {"dispersion": "parameter of --each", "kmax": "parameter of --over, and of --each",
                 "neutral": "parameter solved for, and those of --over and --each",
                 "critical": "parameter solved for", "map": "parameters of --over, and the one solved for"}


def column(name: str, verb: str = "dispersion", bounded: str | None = None) -> Column:
    """Return the `Column` of that name among those of a verb; `bounded` says what its `error` bounds if not the usual.

    Raises KeyError for a name that is none: parameters explain themselves.

    >>> column("k_max", "kmax").units
    '1/L'
    """
    of = bounded or _BOUNDED.get(verb, "sigma")
    units = _ERRORS.get(of, "of that quantity")
    if name == "error":
        return Column(f"bound of the absolute error of {of}", units)
    if name == "data_error":
        return Column(f"standard error of {'the growth rate' if of == 'sigma' else of} from that of the measured base "
                      "flow", units)
    if name == "maxima":
        return _NUMBER_OF_MAXIMA if verb == "map" else _LIST_OF_MAXIMA
    if name == PARAMETERS:
        return Column(_PARAMETER_OF[verb], "its own")
    return COLUMNS[_explained_as(name)]


def known(name: str) -> bool:
    """Return whether a column of that name is explained here. Raises nothing.

    >>> known("degree_24"), known("shields")
    (True, False)
    """
    return name in _VARYING or _explained_as(name) in COLUMNS


def _explained_as(name: str) -> str:
    return ANY_DEGREE if name.startswith("degree_") else name


def explained(verb: str) -> str:
    """Return the columns of a verb as lines for its help; "" for a verb without any.

    Raises nothing: a verb that writes no rows has none.

    >>> print(explained("sensitivity").splitlines()[1])
      parameter      parameter of the flow, or k
    """
    names = BY_VERB.get(verb)
    if not names:
        return ""
    width = max(map(len, names))
    return "\n".join(["columns:", *(f"  {name.ljust(width)}  {column(name, verb)}" for name in names), f"  {SCALES}"])
