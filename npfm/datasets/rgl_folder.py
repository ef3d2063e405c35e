"""A folder of ``.bsdf`` files of the RGL material database (dataset ``rgl``)."""

from pathlib import Path

from npfm.datasets import table_folders
from npfm.errors import NpfmError
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.rgl import is_isotropic, read_bsdf, tabulate
from npfm.reflectance.table import CHANNELS, Table


def materials(folder: str | Path) -> list[str]:
    """Names of the ``.bsdf`` files in a folder, sorted.

    Raises
    ------
    NpfmError
        If there is no such folder, or a file in it would be missed for its ``.BSDF``.
    """
    return table_folders.materials(folder, ".bsdf", "RGL")


def anisotropic(folder: str | Path, name: str) -> bool:
    """Whether a material is anisotropic; no more than the header of its file is read.

    Raises
    ------
    NpfmError
        If folder or file are absent, or the header is not that of a measurement in RGB.
    """
    return not is_isotropic(table_folders.path(folder, name, ".bsdf", "RGL"))


def load(folder: str | Path, name: str, grid: Directional = UTIA) -> Table:
    """Tabulate a material: on the MERL grid, or on a directional one if it is anisotropic.

    Parameters
    ----------
    folder : str or Path
        Folder of ``.bsdf`` files.
    name : str
        A name out of ``materials(folder)``.
    grid : Directional
        Where an anisotropic material is tabulated.

    Returns
    -------
    Table
        BRDF in 1/sr at the centres of cells, negative where it was not measured
        (`npfm.reflectance.rgl`).

    Raises
    ------
    NpfmError
        If folder or file are absent, the file has spectra in place of RGB, is damaged, or has a
        channel that is 0 or not measured in all cells.
    """
    file = table_folders.path(folder, name, ".bsdf", "RGL")
    measured = read_bsdf(file)
    table = tabulate(measured, MERL if measured.isotropic else grid)
    for channel, plane in zip(CHANNELS, table.values, strict=True):
        if not (plane > 0).any():
            raise NpfmError(
                f"{file}: the {channel} channel is 0 or not measured in all cells; nothing can be "
                "fitted to it, so leave this material out"
            )
    return table
