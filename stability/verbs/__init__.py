"""The verbs of the command line, one module each with a function `add(verbs)`."""

from . import compare, critical, dispersion, flows, kmax, map, neutral, sensitivity, spectrum, wellposed

VERBS = (flows, spectrum, dispersion, kmax, neutral, critical, map, sensitivity, compare, wellposed)
