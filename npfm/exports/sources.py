"""What a format is made from: a fit, or a measured table."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from npfm.fitting import fits
from npfm.fitting.fits import FIT, Fit
from npfm.fitting.sources import table
from npfm.reflectance.grids import Grid
from npfm.reflectance.table import Table


@dataclass(frozen=True)
class Source:
    """A material in a file, read when it is asked for and only once.

    Parameters
    ----------
    path : str
        Of a fit (``.npz``), a MERL ``.binary`` or a UTIA ``.bin`` file.
    """

    path: str

    @property
    def name(self) -> str:
        """Of the material."""
        return Path(self.path).stem

    @property
    def is_fit(self) -> bool:
        """Whether it is a fit, by its name."""
        return Path(self.path).suffix == FIT.suffix

    @cached_property
    def fit(self) -> Fit:
        """The fit.

        Raises
        ------
        NpfmError
            If the file is absent or no fit.
        """
        return fits.load(self.path)

    @property
    def grid(self) -> Grid:
        """Where it has values; no fit is tabulated for it."""
        return self.fit.grid if self.is_fit else self.table.grid

    @cached_property
    def table(self) -> Table:
        """BRDF in 1/sr at every cell of its grid; of a fit, by its model.

        Raises
        ------
        NpfmError
            If the file is absent or damaged, or the arrays of a fit are not those of its model.
        """
        return table(self.path)
