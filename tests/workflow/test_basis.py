import pandas as pd
import pytest

MATERIALS = ["chalk", "pink-felt", "satin-copper", "terracotta"]


@pytest.fixture
def small(fresh):
    """Four materials, one scene, and as little as the targets can do."""
    models = 'MODELS = ("independent-g", "shared-lobes")'
    fresh.edit("npfm/run/basis.py", models, 'MODELS = ("independent-g",)')
    fresh.edit("npfm/run/basis.py", "CURVES = (1, 2, 3, 5, 8, 12, 20)", "CURVES = (1, 2)")
    own = {"name": "mine", "model": "independent-g", "starts": 2}
    fresh.configure(
        dataset={"kind": "synthetic", "materials": MATERIALS},
        variants=["bivariate", own],
        models={"independent-g": {"starts": 2}},
        scenes={"A": fresh.config["scenes"]["A"]},
        accuracy_cost=fresh.config["accuracy_cost"] | {"scene": "A"},
    )
    return fresh


def test_the_targets_make_tables_and_figures(small):
    run = small.snakemake("basis", "uniqueness")
    assert run.returncode == 0, run.stdout + run.stderr
    results = small.folder / "results/tiny"
    for figure in ("basis", "basis_curves", "uniqueness"):
        assert (results / f"figures/{figure}.pdf").stat().st_size > 0
    basis = pd.read_csv(results / "tables/basis.csv")
    rows = list(zip(basis["variant"], basis["way"], basis["curves"], strict=True))
    assert rows == [
        ("mine", way, n)
        for way, n in (
            ("free", 0),
            ("fitted", 1),
            ("projected", 1),
            ("fitted", 2),
            ("projected", 2),
        )
    ]
    assert (basis["materials"] == len(MATERIALS)).all()
    channels = pd.read_csv(results / "tables/uniqueness.csv")
    assert channels["material"].unique().tolist() == sorted(MATERIALS)
    assert (channels["starts"] == 2).all()
    summary = pd.read_csv(results / "tables/uniqueness_summary.csv", index_col="quantity")
    assert summary.loc["channels", "value"] == 3 * len(MATERIALS)
    # The run's own fits are not made again.
    assert not (results / "basis/fits").exists() and not (results / "uniqueness/fits").exists()
