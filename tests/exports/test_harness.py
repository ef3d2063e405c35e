"""What every format has to do. A new file in npfm/exports is tested here as it is."""

import numpy as np
import pytest
from glossy import glossy

from npfm.__main__ import main
from npfm.exports import registry
from npfm.fitting import fits
from npfm.fitting import registry as models
from npfm.fitting.objective import Objective
from npfm.fitting.solvers.choice import chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models import ggx_fitted
from npfm.reflectance.merl import write_binary
from npfm.reflectance.table import Table
from npfm.reflectance.utia import write_bin

FORMATS = sorted(registry.formats())
#: What any format is tried with that does not name its models.
ANY_MODEL = "ggx-fitted"


@pytest.fixture(scope="module")
def fit_of(tmp_path_factory):
    """A function that returns the path of a fit of a model, made once."""
    folder, made = tmp_path_factory.mktemp("fits"), glossy()

    def path(name):
        file = folder / name / "glossy.npz"
        if not file.exists():
            solve = chosen(SolverSettings(max_iterations=2), after_start=lambda: None)
            starts = {"starts": 1} if "starts" in models.declared(name).settings else {}
            fits.save(file, models.model(name).fit(made, Objective(), solve, 1, **starts))
        return file

    return path


def tried(name):
    """Models that a format is tried with."""
    return registry.declared(name).models or (ANY_MODEL,)


def said(capsys, *words):
    """What is said where a call is refused, in one line."""
    assert main(["export", *map(str, words)]) == 1
    text = capsys.readouterr().err
    assert text.startswith("npfm export: ") and text.count("\n") == 1
    return text


@pytest.mark.parametrize(
    ("name", "model"), [(name, model) for name in FORMATS for model in tried(name)]
)
def test_a_fit_is_written_twice_the_same(name, model, fit_of, tmp_path):
    known = registry.declared(name)
    outputs = [tmp_path / f"{k}" / f"out{known.suffix}" for k in range(2)]
    for output in outputs:
        assert main(["export", str(fit_of(model)), "--to", name, "-o", str(output)]) == 0
    first, second = (
        {p.relative_to(output): p.read_bytes() for p in [output, *output.rglob("*")] if p.is_file()}
        for output in outputs
    )
    assert first == second and first


@pytest.mark.parametrize("name", FORMATS)
def test_a_format_says_what_it_is(name, capsys):
    known = registry.declared(name)
    assert known.load().KIND.suffix == known.suffix
    assert known.about and "\n" not in known.about
    assert all(model in models.models() for model in known.models)
    with pytest.raises(SystemExit):
        main(["export", "--help"])
    assert f"  {name} " in capsys.readouterr().out


@pytest.mark.parametrize("name", FORMATS)
def test_what_a_format_cannot_hold_is_refused(name, fit_of, tmp_path, capsys):
    known, output = registry.declared(name), tmp_path / f"out{registry.declared(name).suffix}"
    end = ("--to", name, "-o", output)
    good = fit_of(tried(name)[0])
    assert "no such file" in said(capsys, tmp_path / "none.npz", *end)
    if not known.many:
        assert "of one material" in said(capsys, good, good, *end)
    if not known.tables:
        write_binary(tmp_path / "glossy.binary", glossy())
        assert "fit a model" in said(capsys, tmp_path / "glossy.binary", *end)
    if known.models:
        other = next(m for m in ("ggx-fitted", "bivariate") if m not in known.models)
        assert f"a fit of {other}" in said(capsys, fit_of(other), *end)
    if "directional" not in known.grids and not known.models:
        turned = turned_fit(tmp_path)
        assert "on a directional grid" in said(capsys, turned, *end)
    damaged = tmp_path / "damaged.npz"
    damaged.write_bytes(good.read_bytes()[:-100])
    assert "damaged.npz" in said(capsys, damaged, *end)
    if known.suffix:
        assert "give a name that ends so" in said(capsys, good, *end[:-1], tmp_path / "out.txt")
    assert not output.exists()


def turned_fit(folder):
    from npfm.reflectance.directional import Directional

    grid = Directional(3, 4, 3, 4)
    table = Table(np.full((3, *grid.shape), 0.1), grid)
    write_bin(folder / "flat.bin", table)
    fits.save(folder / "turned.npz", ggx_fitted.fit(table, Objective(), None, 1))
    return folder / "turned.npz"


def test_an_unknown_format_is_answered_with_the_nearest(fit_of, tmp_path, capsys):
    text = said(capsys, fit_of(ANY_MODEL), "--to", "merl1", "-o", tmp_path / "a.binary")
    assert "did you mean merl" in text
