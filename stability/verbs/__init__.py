"""The verbs of the command line, one module each with a function `add(verbs)`."""

from . import critical, dispersion, flows, kmax, neutral, spectrum, wellposed

VERBS = (flows, spectrum, dispersion, kmax, neutral, critical, wellposed)
