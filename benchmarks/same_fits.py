"""Whether two runs have the same fits, byte for byte: before and after a change of the code.

    python benchmarks/same_fits.py results-before/neural-10 results/neural-10

Prints, for each variant, how many fits are the same, and the names of those that are not. Fits that
only one of the runs has are named too. Exits with 1 if a fit that both have differs.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path


def fits(run: Path) -> dict[str, Path]:
    """Fits of a run by variant and material."""
    folder = run / "fits"
    return {
        path.relative_to(folder).with_suffix("").as_posix(): path for path in folder.glob("*/*.npz")
    }


def compared(before: Path, after: Path) -> Iterator[tuple[str, int, list[str], list[str]]]:
    """For each variant, the number of equal fits, the names of others, and of those in one run."""
    old, new = fits(before), fits(after)
    for variant in sorted({name.split("/")[0] for name in {*old, *new}}):
        mine = sorted(name for name in {*old, *new} if name.split("/")[0] == variant)
        both = [name for name in mine if name in old and name in new]
        other = [name for name in both if old[name].read_bytes() != new[name].read_bytes()]
        yield variant, len(both) - len(other), other, [name for name in mine if name not in both]


def main() -> int:
    """Print the comparison."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("before", type=Path, help="folder of a run")
    parser.add_argument("after", type=Path, help="folder of the other")
    arguments = parser.parse_args()
    differ = False
    for variant, equal, other, alone in compared(arguments.before, arguments.after):
        said = [f"{equal} equal"]
        said += [f"different: {' '.join(other)}"] if other else []
        said += [f"in one run alone: {' '.join(alone)}"] if alone else []
        print(f"{variant}: {'; '.join(said)}")
        differ |= bool(other)
    return int(differ)


if __name__ == "__main__":
    sys.exit(main())
