def test_a_figure_is_made_where_the_run_has_what_it_compares(project):
    project.configure(variants=["bivariate", "naive", "independent-g"])
    figures = {name for name in project.planned() if name.startswith("figures/figure")}
    pictures = {f"figures/figure{n:02}.{end}" for n in (9, 10, 11) for end in ("pdf", "png")}
    assert pictures <= figures
    assert not {f"figures/figure{n}.pdf" for n in (12, 13, 14)} & figures
