"""What the figure scripts share: where results go, and how they are written."""

import argparse
import csv
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

from stability.numerics.threads import one_thread  # noqa: E402
from stability.output.style import BLUE, GREY, RED, STYLE  # noqa: E402

GREEN, ORANGE = "#2e8b57", "#d98200"
__all__ = ["BLUE", "GREEN", "GREY", "ORANGE", "RED", "main", "plt"]


def main(script, compute, draw):
    """Run a figure script: compute, draw, and write the image and the plotted numbers beside it.

    `compute(fast)` returns {column: values}, equally long; `draw(data)` returns a matplotlib figure.
    """
    parser = argparse.ArgumentParser(description=f"Draw {Path(script).stem}.png and write its numbers as CSV.")
    parser.add_argument("--fast", action="store_true", help="coarser, for a quick look")
    parser.add_argument("--out", type=Path, default=Path(script).parent, metavar="DIR", help="where to write")
    arguments = parser.parse_args()
    data = one_thread(compute)(arguments.fast)
    arguments.out.mkdir(parents=True, exist_ok=True)
    target = arguments.out / Path(script).stem
    with plt.rc_context({name: value for name, value in STYLE.items() if name != "axes.prop_cycle"}):
        draw(data).savefig(target.with_suffix(".png"), metadata={"Software": None})
    write_csv(target.with_suffix(".csv"), data)
    print(target.with_suffix(".png"))


def write_csv(path, data):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(data)
        writer.writerows(zip(*data.values(), strict=True))
