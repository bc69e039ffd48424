"""`python -m asymptotics` is the command `asymptotics`."""

import gc
import sys
from typing import NoReturn

from .cli import main


def run() -> NoReturn:
    """Run the command and end the process."""
    status = main()
    gc.freeze()  # nobody need look through what is left for what could be freed: all of it is
    sys.exit(status)


if __name__ == "__main__":
    run()
