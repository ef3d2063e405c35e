"""Log-factors of the fits of many materials, with what samples see of them: what a basis is of."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.basis.curves import Basis, basis_of, log_factors
from npfm.fitting.basis.lobes import (
    FACTORS,
    MODELS,
    MOST_LOBES,
    Lobes,
    cells,
    checked_lobes,
    seen_by,
)
from npfm.fitting.factors.microfacet import G_NODES
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.shared_lobes.problem import CLAMP
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.table import CHANNELS
from npfm.storage.archives import read_arrays
from npfm.storage.files import Kind, marked, replacing

FORMAT = "npfm-factors-1"
LIBRARY = Kind(
    "factors of many fits", ".npz", marked(b"factors.npy", b"material.npy", b"seen_D.npy")
)
#: Curves of fewer materials say next to nothing of another one.
FEWEST = 3
#: A thousand materials have six million bytes.
MOST_BYTES = 2**28
AGAIN = "make it again with npfm basis gather"

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Library:
    """Factors of many fits of one model.

    Parameters
    ----------
    model : str
        One of `MODELS`.
    grid : HalfDifference
    spline : bool
        Whether G is read along a spline.
    materials : tuple of str
        Of each group: the lobes of channels that share them.
    logs : dict of str to ndarray
        Of D, F and G: logarithms, shapes (groups, lobes, theta_h), (groups, channels, theta_d)
        and (groups, lobes, nodes).
    seen : dict of str to ndarray
        What the samples see of each value (see `npfm.fitting.basis.lobes.Seen`), the same shapes.
    """

    model: str
    grid: HalfDifference
    spline: bool
    materials: tuple[str, ...]
    logs: Mapping[str, Array]
    seen: Mapping[str, Array]

    @property
    def single(self) -> bool:
        """Whether it is of independent-g."""
        return self.model == MODELS[0]

    @property
    def lobes(self) -> int:
        """How many lobes a group has."""
        return self.logs["D"].shape[1]

    @property
    def channels(self) -> int:
        """How many channels share the lobes of a group: 1 or 3."""
        return self.logs["F"].shape[1]

    @property
    def form(self) -> tuple[str, HalfDifference, bool, int, int]:
        """What fits have to have in common with those that it is of."""
        return self.model, self.grid, self.spline, self.lobes, self.channels

    def unknowns(self, count: int) -> int:
        """How many numbers a material has in a basis of so many curves, coefficients and rho."""
        groups = len(CHANNELS) // self.channels
        return groups * (
            count * (2 * self.lobes + self.channels) + self.channels * (self.lobes + 1)
        )

    def basis_values(self, count: int) -> int:
        """How many numbers the curves have that all materials share, the means among them."""
        return (count + 1) * sum(array.shape[2] for array in self.logs.values())

    def without(self, material: str) -> "Library":
        """Return the factors of all materials but one, which need not be there.

        Raises
        ------
        NpfmError
            If fewer than `FEWEST` materials are left.
        """
        kept = np.array([name != material for name in self.materials])
        names = tuple(name for name in self.materials if name != material)
        if len(set(names)) < FEWEST:
            raise NpfmError(
                f"a basis without {material} would be of {len(set(names))} materials; "
                f"give fits of {FEWEST} others or more"
            )
        logs, seen = (
            {name: array[kept] for name, array in of.items()} for of in (self.logs, self.seen)
        )
        return replace(self, materials=names, logs=logs, seen=seen)

    def bases(self, count: int) -> dict[str, Basis]:
        """Return a basis of so many curves of D, of F and of G; every material counts alike.

        Weights are the roots of what samples see in the mean: by these alone, curves go astray at
        grazing directions, which count little in the objective and show in pictures.
        """
        found = {}
        for name in FACTORS:
            logs, seen = (of[name].reshape(-1, of[name].shape[2]) for of in (self.logs, self.seen))
            total = seen.sum(1, keepdims=True)
            shares = np.divide(seen, total, out=np.zeros_like(seen), where=total > 0)
            weights = np.sqrt(shares.mean(0))
            found[name] = basis_of(logs, weights if weights.any() else weights + 1, count)
        return found


def gather(fits: Mapping[str, Fit], objective: Objective) -> Library:
    """Take the factors of fits apart.

    Parameters
    ----------
    fits : mapping of str to Fit
        By material, or by path: of one of `MODELS`, all with the same settings.
    objective : Objective
        What the fits were made by: it says what samples see.

    Raises
    ------
    NpfmError
        If they are of different models, settings or grids, or of others, or have arrays that are
        not those of their model.
    """
    first = next(iter(fits.values()))
    spline = "spline" in first.parameters
    for name, fit in fits.items():
        if fit.model not in MODELS or not isinstance(fit.grid, HalfDifference):
            raise NpfmError(
                f"{name}: a fit of '{fit.model}' on {fit.grid.name}; a basis is made of fits of "
                f"{' or '.join(MODELS)} to tables on a half-difference grid"
            )
        if _form(fit) != _form(first):
            raise NpfmError(f"{name}: its model, settings or grid are not those of the others")
    at = cells(first.grid, objective, spline)
    names, found = [], []
    for name, fit in fits.items():
        for lobes in _lobes(name, fit):
            names.append(name)
            found.append((lobes, seen_by(lobes, at)))
    logs = {
        name: log_factors([getattr(lobes, name) for lobes, _ in found], CLAMP) for name in FACTORS
    }
    seen = {name: np.stack([getattr(each, name) for _, each in found]) for name in FACTORS}
    return Library(first.model, first.grid, spline, tuple(names), logs, seen)


def _lobes(name: str, fit: Fit) -> list[Lobes]:
    try:
        return checked_lobes(fit)
    except NpfmError as error:
        raise NpfmError(f"{name}: {error}") from error


def _form(fit: Fit) -> tuple:
    shapes = {name: array.shape for name, array in fit.parameters.items()}
    return fit.model, fit.grid, tuple(sorted(shapes.items()))


def save(path: str | Path, library: Library) -> None:
    """Write a library (``.npz``, float32)."""
    arrays: dict[str, Any] = {
        "factors": np.array(FORMAT),
        "model": np.array(library.model),
        "grid": np.array(library.grid.shape),
        "spline": np.array(library.spline),
        "material": np.array(library.materials),
    }
    for name in FACTORS:
        arrays[f"log_{name}"] = library.logs[name].astype(np.float32)
        arrays[f"seen_{name}"] = library.seen[name].astype(np.float32)
    with replacing(path, LIBRARY) as temporary:
        np.savez(temporary, **arrays)


def load(path: str | Path) -> Library:
    """Read what `save` wrote.

    Raises
    ------
    NpfmError
        If the file is absent or damaged, or holds something else.
    """
    arrays = read_arrays(path, "factors of many fits", AGAIN, MOST_BYTES)
    if str(arrays.get("factors", "")) != FORMAT:
        raise NpfmError(f"{path}: no factors of format {FORMAT}; {AGAIN}")
    try:
        grid = _grid(arrays["grid"])
        logs = {name: arrays[f"log_{name}"].astype(float) for name in FACTORS}
        seen = {name: arrays[f"seen_{name}"].astype(float) for name in FACTORS}
        names = tuple(map(str, arrays["material"]))
        found = Library(str(arrays["model"]), grid, bool(arrays["spline"]), names, logs, seen)
        _check(found)
    except (LookupError, ValueError, TypeError) as error:
        reason = " ".join(str(error).split())
        raise NpfmError(f"{path}: no factors of many fits ({reason}); {AGAIN}") from error
    return found


def _grid(bins: NDArray) -> HalfDifference:
    """Return the grid of so many bins; ValueError if there is none, or none as large."""
    if bins.shape != (3,) or bins.dtype.kind not in "iu" or bins.min() < 1 or bins[2] % 2:
        raise ValueError(f"a grid of {bins} bins")
    grid = HalfDifference(*bins.tolist())
    if grid.size > MERL.size:
        raise ValueError(f"a grid of {bins} bins")
    return grid


def _check(found: Library) -> None:
    """Refuse arrays that do not belong together.

    Raises
    ------
    ValueError
        Saying why.
    """
    groups, lobes, channels = len(found.materials), found.lobes, found.channels
    if found.model not in MODELS or channels not in (1, len(CHANNELS)):
        raise ValueError(f"of {channels} channels of '{found.model}'")
    if lobes > (1 if found.single else MOST_LOBES) or (found.single and channels > 1):
        raise ValueError(f"of {lobes} lobes that {channels} channels share, by {found.model}")
    sizes = found.grid.theta_h_bins, found.grid.theta_d_bins, G_NODES
    for name, rows, size in zip(FACTORS, (lobes, channels, lobes), sizes, strict=True):
        for array in (found.logs[name], found.seen[name]):
            if array.shape != (groups, rows, size) or not np.isfinite(array).all():
                raise ValueError(f"{name} is of shape {array.shape} or not finite")
        # As `log_factors` makes them, rounded to float32.
        if found.logs[name].max() > 0 or found.logs[name].min() < np.log(CLAMP) - 1e-4:
            raise ValueError(f"logarithms of {name} are not from {np.log(CLAMP):.1f} to 0")
        if found.seen[name].min() < 0:
            raise ValueError(f"what is seen of {name} is negative")
