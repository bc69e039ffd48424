"""Refinement by compiled code, where the extra `fast` is installed."""
