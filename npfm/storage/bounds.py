"""How large a picture may be: a few bytes of a header can ask for all memory there is."""

from pathlib import Path

from npfm.errors import NpfmError

#: A lat-long map of 8192 rows, the largest that light probes are published in; 1.6 GB as floats.
MOST_PIXELS = 2**27


def check_size(path: str | Path, width: int, height: int) -> None:
    """Refuse a picture that is empty or has more than `MOST_PIXELS`."""
    if not 0 < width * height <= MOST_PIXELS:
        raise NpfmError(
            f"{path}: {width} x {height} pixels; give a picture of 1 to {MOST_PIXELS} pixels"
        )
