from npfm.run.power_iterations import FACTORS
from npfm.storage.pictures import read_exr_parts


def test_the_target_makes_tables_and_figures(project):
    """The tiny run has none of the models: they are fitted and rendered for the study alone."""
    run = project.snakemake("power_iterations")
    assert run.returncode == 0, run.stdout + run.stderr
    results = project.folder / "results/tiny"
    for table in ("recovery", "timing", "surfaces", "delta_e"):
        assert (results / f"tables/power_iterations_{table}.csv").stat().st_size > 0
    for figure in ("delta_e", "extraction_time", "side_by_side", "roughness"):
        assert (results / f"figures/power_iterations_{figure}.pdf").stat().st_size > 0
    images = read_exr_parts(results / "power_iterations/delta_e.exr")
    assert list(images) == ["power-iteration", "ggx", "beckmann"]
    edited = {path.stem for path in results.glob("power_iterations/edited/chalk/*.png")}
    assert edited == {*FACTORS, "textured"}
    assert not (results / "fits/ggx").exists()
