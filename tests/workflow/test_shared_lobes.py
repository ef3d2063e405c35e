import pandas as pd


def test_the_target_makes_tables_and_figures(project):
    """The tiny run has neither of the models: they are fitted and compared for the study alone."""
    project.edit("npfm/run/shared_lobes.py", "LOBES = (1, 2, 3, 5)", "LOBES = (1, 3)")
    run = project.snakemake("shared_lobes")
    assert run.returncode == 0, run.stdout + run.stderr
    results = project.folder / "results/tiny"
    for figure in ("psnr", "factors", "sampling"):
        assert (results / f"figures/shared_lobes_{figure}.pdf").stat().st_size > 0
    psnr = pd.read_csv(results / "tables/shared_lobes_psnr.csv")
    assert set(psnr.variant) == {"shared-lobes", "independent-g", "bivariate"}
    lobes = pd.read_csv(results / "tables/shared_lobes_lobes.csv")
    assert sorted(zip(lobes.lobes, lobes.shared, strict=True)) == [
        (n, shared) for n in (1, 3) for shared in (0, 1)
    ]
    assert lobes.set_index(["lobes", "shared"]).loc[(3, 1)].bytes == 4 * 822
    sampling = pd.read_csv(results / "tables/shared_lobes_sampling.csv")
    assert set(sampling.way) == {"cosine", "D", "D and cosine"}
    fits = {path.name for path in results.glob("shared_lobes/fits/*")}
    assert "lobes-3-shared" not in fits  # the same as the default, made once
    assert not (results / "shared_lobes/fits/bivariate").exists()  # the run's own
