"""The thesis's method: the boundary-value problem, continued along k."""
