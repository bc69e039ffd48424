"""`python -m stability` is the command `stability`."""

import sys

from .cli import main

sys.exit(main())
