"""python -m stability.numerics.kernel: make the compiled kernel now, and say where it is."""

import argparse
import sys

from .build import NoKernel, build_kernel, built_meanwhile


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m stability.numerics.kernel",
                                     description="Make the compiled kernel now, and say where it is.")
    parser.add_argument("--meanwhile", action="store_true", help="say nothing, for a program that goes on without it")
    if parser.parse_args().meanwhile:
        built_meanwhile()
        return 0
    try:
        sys.stdout.write(f"{build_kernel()}\n")
    except NoKernel as failure:
        sys.stderr.write(f"kernel: {failure}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
