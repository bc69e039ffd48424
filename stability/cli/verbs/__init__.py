"""The verbs of the command line, one module each with a function `add(verbs)`; here their names and what they answer.

A module is imported when its verb is named.
"""

VERBS = {
    "flows": "flows, parameters, defaults, ranges, scales",
    "base": "profiles of the base flow: velocity, stresses, viscosities",
    "spectrum": "the least stable modes at one wavenumber",
    "dispersion": "growth rate and phase speed over wavenumbers",
    "kmax": "the fastest growing wavenumber, over a parameter",
    "neutral": "the value of a parameter at which growth vanishes, over another or over k",
    "critical": "the value of a parameter at which the first wavenumber becomes unstable",
    "map": "a quantity over one to three parameters, on all cores; continues after Ctrl-C",
    "sensitivity": "how growth rate and phase speed change with every parameter",
    "explore": "a window: dispersion relation with a slider for every parameter",
    "compare": "all methods on one eigenvalue: values, errors, times",
    "wellposed": "where the equations are ill posed, and how internal modes grow with k",
}
