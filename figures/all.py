"""Draw every figure of this folder, images and CSV files. Options go to each script: --fast, --out DIR."""

import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
NOT_FIGURES = {"all.py", "style.py"}

if __name__ == "__main__":
    for script in sorted(HERE.glob("*.py")):
        if script.name not in NOT_FIGURES:
            subprocess.run([sys.executable, script, *sys.argv[1:]], check=True)
