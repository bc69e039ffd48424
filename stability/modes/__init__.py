"""Eigenvalues and modes at one wavenumber, and one mode followed along k."""
