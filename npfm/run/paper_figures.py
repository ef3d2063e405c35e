"""What Figures 3 to 7 and 9 to 16 are drawn from, as far as a run has it."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from npfm.figures.compared import LABELS, compared
from npfm.fitting import registry
from npfm.papers.captions import CAPTIONS, chosen
from npfm.run.config import Run
from npfm.run.weighting import MODELS, Weighting
from npfm.run.words import as_input, option, path_word


@dataclass(frozen=True)
class Drawn:
    """How a figure is drawn.

    Parameters
    ----------
    files : list of str
        What is made before it.
    arguments : str
        Of ``npfm figure``.
    label : str
        What it is, in a list of figures.
    models : list of str
        Modules of the models whose fits it evaluates.
    """

    files: list[str]
    arguments: list[str]
    label: str
    models: list[str] = field(default_factory=list)


def drawn(run: Run, weighting: Weighting) -> dict[str, Drawn]:
    """Figures by name; those of models that the run does not have are left out."""
    models = [model for model in MODELS if model in run.variants]
    figures = {"figure04": Drawn([], [], "4: the compressive function")}
    if not run.grid.anisotropic:
        figures["figure03"] = _weights(run)
    if models:
        figures["figure05"] = _slices(run, models)
    if MODELS[0] in models:
        figures |= {"figure06": _factors(run), "figure16": _texture(run)}
    for number in weighting.columns:
        figures[f"figure{number:02}"] = _renderings(run, weighting, number)
    figures |= {name: _compared(run, name, shown) for name, shown in compared(run.variants).items()}
    return dict(sorted(figures.items()))


def _weights(run: Run) -> Drawn:
    [table] = _tables(run, chosen(CAPTIONS[3], run.materials))
    return Drawn([table], ["--table", table], "3: weights of the objective")


def _slices(run: Run, models: list[str]) -> Drawn:
    materials = chosen(CAPTIONS[5], run.materials)
    files = _tables(run, materials) + [f for m in models for f in _fits(run, m, materials)]
    names = ["--materials", *materials, "--variants", *models]
    modules = [registry.declared(model).module for model in models]
    return Drawn(files, ["--run", run.folder, *names], "5: measured and fitted slices", modules)


def _factors(run: Run) -> Drawn:
    made = _fits(run, MODELS[0], chosen(CAPTIONS[6], run.materials))
    arguments = ["--fits", *made]
    label = "6: factors"
    files = [*made, *map(as_input, run.published_factors)]
    given = option("--published", map(path_word, run.published_factors))
    return Drawn(files, [*arguments, *given], label)


def _texture(run: Run) -> Drawn:
    made = _fits(run, MODELS[0], run.materials)
    return Drawn(made, option("--fits", made), "16: texture of all fits")


def _renderings(run: Run, weighting: Weighting, number: int) -> Drawn:
    table = f"{run.folder}/tables/weighting.csv"
    pairs = weighting.pictures[number].items()
    names = [
        *("--run", run.folder, "--scene", run.scenes[0]),
        *("--materials", *weighting.materials[number]),
        *("--columns", *(f"{heading}={','.join(pair)}" for heading, pair in pairs)),
    ]
    # The table stands for the pictures: it is made from all of them.
    labels = {7: "7: compressive weighting", 15: "15: restricted range of angles"}
    return Drawn([table], [*names, "--psnr", table], labels[number])


def _compared(run: Run, figure: str, variants: list[str]) -> Drawn:
    # The table stands for the pictures: it is made from all of them.
    table = f"{run.folder}/tables/psnr.csv"
    names = ["--run", run.folder, "--variants", *variants]
    return Drawn([table], [*names, "--psnr", table], LABELS[figure])


def _tables(run: Run, materials: Sequence[str]) -> list[str]:
    return [run.table(name) for name in materials]


def _fits(run: Run, variant: str, materials: Sequence[str]) -> list[str]:
    return [f"{run.folder}/fits/{variant}/{name}.npz" for name in materials]
