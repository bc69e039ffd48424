"""Chebyshev series, bordered band matrices and the refinement of an eigenvalue: no physics."""
