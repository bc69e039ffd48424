"""python -m stability.docs: write the pages."""

import sys

from .build import main

if __name__ == "__main__":
    sys.exit(main())
