"""Small-parameter expansions of linear stability problems, derived exactly from the nonlinear equations.

>>> from asymptotics import expand
>>> expand("vortex", slope_deg=45, order=2).growth_rate
-2*k**2/5
"""

__version__ = "0.1.0"

from .flows import expand
from .series import Expansion

__all__ = ["Expansion", "expand"]
