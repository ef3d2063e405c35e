def test_the_page_is_made_from_what_the_run_has(project):
    run = project.snakemake("reproduction")
    assert run.returncode == 0, run.stdout + run.stderr
    page = (project.folder / "results" / "tiny" / "reproduction.md").read_text()
    assert "The materials are made by formulas" in page
    assert "![figure08_by_diffuseness](figures/figure08_by_diffuseness.png)" in page
    assert "| average of bivariate | 64.07 dB |" in page
    assert "the run has no independent-g" in page
