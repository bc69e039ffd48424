"""python -m asymptotics"""

import sys

from .cli import main

sys.exit(main())
