"""The values of a fit as a table of MERL's format, as ``npfm tabulate`` writes it."""

from collections.abc import Sequence

from npfm.exports.sources import Source
from npfm.reflectance.merl import BINARY, write_binary

NAME = "merl"
ABOUT = "a MERL .binary, for any program that reads measured materials"
SUFFIX = ".binary"
KIND = BINARY


def write(path: str, sources: Sequence[Source]) -> None:
    """Write the table of a fit."""
    [source] = sources
    write_binary(path, source.table)
