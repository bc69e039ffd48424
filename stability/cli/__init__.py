"""The command `stability`: reading the line, asking the studies, writing what they find."""

from .command import main

__all__ = ["main"]
