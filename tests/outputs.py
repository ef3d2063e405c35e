"""What a run makes, for comparing one with another."""

from pathlib import Path

#: What holds seconds: records of fits, and the tables gathered from them.
TIMED = ("*.json", "tables/fits.csv", "figures/table1.csv")


def untimed(results: Path) -> dict[str, bytes]:
    """Return the contents of every output that is the same in each run, by its relative name."""
    names = sorted(path.relative_to(results) for path in results.rglob("*") if path.is_file())
    return {
        str(name): (results / name).read_bytes()
        for name in names
        if name.parts[0] != "logs" and not any(name.match(pattern) for pattern in TIMED)
    }
