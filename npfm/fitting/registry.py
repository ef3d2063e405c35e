"""Models by name. Each is imported when it is asked for.

A model is a file under `npfm/models` that has a constant NAME; there is no other list of models.
What the file declares is read from its syntax, so that nothing is imported only to check a
configuration. Here models are imported by a name that is only known when it runs, which
`npfm.run.provenance` refuses to digest: whoever runs a model names the model's own module as an
entry.
"""

import importlib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

from numpy.typing import NDArray

from npfm.declarations import named_files
from npfm.errors import NpfmError, suggest
from npfm.fitting import fits
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

FOLDER = Path(__file__).parents[1] / "models"
#: What the module of a model has to have.
INTERFACE = ("fit", "tabulate", "parameter_count")


#: By kind of a file that parameters were published in, the module that reads it: the function
#: `read` takes the path, and as keywords what the model says that the file holds. Models import the
#: one they need, too, so that it is among the code that they depend on.
READERS = {
    "fits": "npfm.datasets.parameter_files",
    "factors": "npfm.datasets.published_factors",
}


@dataclass(frozen=True)
class Published:
    """A file of parameters that others published.

    Parameters
    ----------
    kind : str
        Which of `READERS` reads it; the key of a configuration that says where it is begins with
        ``published_``.
    name : str
        Of the file.
    holds : mapping
        What it holds, as its reader has to be told.
    """

    kind: str
    name: str
    holds: Mapping[str, Any] = field(default_factory=dict)

    def read(self, path: str | Path) -> Mapping[str, Mapping[str, NDArray]]:
        """Read a file of this kind.

        Returns
        -------
        mapping of str to (mapping of str to ndarray)
            By material, the parameters by their names.

        Raises
        ------
        NpfmError
            If the file is absent or holds something else.
        """
        reader = importlib.import_module(READERS[self.kind])
        return reader.read(path, **self.holds)


@dataclass(frozen=True)
class Model:
    """What the file of a model declares, each in a constant of that name in capitals.

    Parameters
    ----------
    module : str
        Full name of the module that the file is.
    coefficients : tuple of str
        Parameters that carry the unit of the BRDF.
    signed : tuple of str
        Parameters that may be negative.
    reciprocal : bool
        Whether exchanging light and view leaves its tables as they are.
    solver : bool
        Whether `fit` runs the solver that it is given.
    objective : bool
        Whether `fit` minimises the objective that it is given, and not one of its own.
    random : bool
        Whether a start of `fit` is random, so that the seed matters.
    settings : mapping of str to (str or mapping of str to str)
        What `fit` takes as keywords: a whole number, with what it means, or one of a few words,
        with what each means.
    own_table : float
        Share of the objective that may be left when a table of the model's own is fitted.
    shared : tuple of str
        Parameters that the channels have together: stored once, their first axis of length 1.
    converted : bool
        Whether `fit` makes parameters out of those of another model, and fits none to the table.
    scale_free : bool
        Whether a brighter table has larger coefficients and all else the same.
    grids : tuple of str
        Kinds of the grids whose tables it is for.
    published : Published, optional
        For a model that is not fitted but read: what it is read from.
    """

    module: str
    coefficients: tuple[str, ...] = ()
    signed: tuple[str, ...] = ()
    reciprocal: bool = True
    solver: bool = True
    objective: bool = True
    random: bool = False
    settings: Mapping[str, str | Mapping[str, str]] = field(default_factory=dict)
    own_table: float = 1e-8
    shared: tuple[str, ...] = ()
    converted: bool = False
    scale_free: bool = True
    grids: tuple[str, ...] = (HalfDifference.kind,)
    published: Published | None = None

    def load(self) -> ModuleType:
        """Import the model: its `fit`, `tabulate` and `parameter_count`.

        Raises
        ------
        NpfmError
            If its file lacks one of the three.
        """
        module = importlib.import_module(self.module)
        if missing := [function for function in INTERFACE if not hasattr(module, function)]:
            raise NpfmError(f"{module.__file__}: no function '{missing[0]}'; every model needs one")
        return module


@cache
def models() -> Mapping[str, Model]:
    """Return what the models declare, by name, sorted.

    Raises
    ------
    NpfmError
        If the file of a model cannot be parsed, a declaration in it is no literal, or two files
        have the same name for their model.
    """
    known = {field.name for field in fields(Model)} - {"module"}
    return {
        name: _model(f"npfm.models.{path.stem}", constants)
        for name, (path, constants) in named_files(FOLDER, known, "model").items()
    }


def _model(module: str, constants: Mapping[str, Any]) -> Model:
    source = constants.get("published")
    return Model(module, **{**constants, "published": Published(**source) if source else None})


def fitted() -> tuple[str, ...]:
    """Return the models that are fitted, rather than read from a file of their authors."""
    return tuple(name for name, model in models().items() if not model.published)


def declared(name: str) -> Model:
    """Return what the model of that name declares.

    Raises
    ------
    NpfmError
        If there is no model of that name.
    """
    if name not in models():
        raise NpfmError(f"unknown model '{name}'; {suggest(name, models())}")
    return models()[name]


def check_grid(name: str, kind: str) -> None:
    """Refuse a model that is not for tables on a kind of grid.

    Raises
    ------
    NpfmError
        If there is no model of that name, or it is not for these.
    """
    if kind not in declared(name).grids:
        others = [other for other, model in models().items() if kind in model.grids]
        hint = f"choose from {', '.join(others)}" if others else "no model is"
        raise NpfmError(f"'{name}' is not for tables on a {kind} grid; {hint}")


def model(name: str) -> ModuleType:
    """Return the module of the model of that name: `fit`, `tabulate` and `parameter_count`.

    Raises
    ------
    NpfmError
        If there is no model of that name, or its file lacks one of the three.
    """
    return declared(name).load()


def tabulated(path: str | Path) -> Table:
    """Values of a fit out of a file (``.npz``), by the model that made it.

    Raises
    ------
    NpfmError
        If the file is no fit, its model is unknown, or its arrays are not those of its model.
    """
    fit = fits.load(path)
    try:
        check_grid(fit.model, fit.grid.kind)
        module = model(fit.model)
    except NpfmError as error:
        raise NpfmError(f"{path}: {error}") from error
    return fits.tabulate(path, fit, module)
