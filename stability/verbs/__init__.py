"""The verbs of the command line, one module each with a function `add(verbs)`."""

from . import dispersion, flows, kmax, spectrum, wellposed

VERBS = (flows, spectrum, dispersion, kmax, wellposed)
