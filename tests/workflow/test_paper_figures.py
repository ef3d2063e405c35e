ENDS = "pdf", "png"


def files(*numbers):
    return {f"figures/figure{number:02}.{end}" for number in numbers for end in ENDS}


def test_a_figure_is_made_where_the_run_has_what_it_compares(project):
    project.configure(variants=["bivariate", "naive", "independent-g"])
    figures = {name for name in project.planned("figures") if name.startswith("figures/figure")}
    assert files(6, 9, 10, 11, 15, 16) <= figures
    assert not files(12, 13, 14) & figures


def test_a_figure_needs_no_variant_or_those_that_the_run_has(finished):
    figures = finished.folder / "results" / "tiny"
    made = {f"figures/{path.name}" for path in figures.glob("figures/figure??.*")}
    assert made == files(3, 4, 5, 7)


def test_an_edit_of_a_model_reruns_its_unweighted_fits_and_the_figures_of_it(project):
    project.edit("npfm/models/naive.py", "CLAMP = 1e-6", "CLAMP = 1e-5")
    planned = project.planned("figures")
    fit = {f"weighting/fits/naive-to-89-unweighted/chalk.{end}" for end in ("npz", "json")}
    renders = {
        f"renders/{scene}/chalk/naive-to-89-unweighted.{end}"
        for scene in ("A", "C")
        for end in ("exr", "png")
    }
    assert files(5, 7) | fit | renders | {"tables/weighting.csv"} <= planned
    assert not files(3, 4) & planned


def test_an_edit_of_a_figure_reruns_it_alone(project):
    project.edit("npfm/figures/figure04.py", "LARGEST = 6.0", "LARGEST = 7.0")
    assert project.planned("figures") == files(4)
