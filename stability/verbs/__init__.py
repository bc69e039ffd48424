"""The verbs of the command line, one module each with a function `add(verbs)`."""

from . import compare, critical, dispersion, flows, kmax, neutral, sensitivity, spectrum, wellposed

VERBS = (flows, spectrum, dispersion, kmax, neutral, critical, sensitivity, compare, wellposed)
