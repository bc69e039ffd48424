"""`python -m stability` is the command `stability`."""

import sys

from .cli.command import main

sys.exit(main())
