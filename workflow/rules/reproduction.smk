from npfm.run.study import table_inputs

# What the page is made from, as far as the run has it: the option of each, and the file.
CLAIMED = {
    "psnr": rules.psnr_table.output,
    "summary": rules.summary_table.output,
    "fits": rules.fits_table.output,
}
if RUN.grid.anisotropic:
    CLAIMED["fidelity"] = rules.fidelity_table.output
if "naive" in RUN.variants:
    CLAIMED["materials"] = rules.materials_table.output
# Not made for the page alone: it takes longer than the page.
CLAIMED |= {
    key: table
    for key, name in [("variance", "variance"), ("levels", "psnr_level")]
    for table in table_inputs(RUN, name)
}
if WEIGHTING.columns:
    CLAIMED["weighting"] = rules.weighting_table.output
if RUN.published_factors and "independent-g" in RUN.variants:
    CLAIMED["published"] = f"{OUT}/tables/published.csv"


localrules:
    reproduction,


use rule npfm as published_table with:
    input:
        factors=lambda wildcards: map(as_input, RUN.published_factors),
        tables=expand(rules.material.output, material=RUN.materials),
        fits=expand(
            rules.fit.output.fit, material=RUN.materials, variant="independent-g"
        ),
    output:
        f"{OUT}/tables/published.csv",
    log:
        f"{OUT}/logs/tables/published.log",
    resources:
        mem_mb=1000,
        runtime=15,
    params:
        verb="tables published",
        code=command_code(
            "tables published",
            *RUN.model_modules(*RUN.variants.keys() & {"independent-g"}),
        ),
        files=lambda wildcards, output: ["-o", *output],
        options=lambda wildcards: [
            *MATERIALS,
            *option("--factors", map(path_word, RUN.published_factors)),
        ],


use rule npfm as reproduction with:
    input:
        **CLAIMED,
        records=expand(
            rules.fit.output.record,
            material=RUN.materials,
            variant=[name for name in ["independent-g"] if name in RUN.variants],
        ),
        figures=[
            *expand(f"{OUT}/figures/figure08_by_{{order}}.png", order=RUN.orders),
            *expand(f"{OUT}/figures/{{figure}}.png", figure=DRAWN),
            *([rules.fidelity_figure.output.png] if RUN.grid.anisotropic else []),
            *(
                f"{OUT}/figures/importance_{figure}.png"
                for figure in ["improvement", "samples"]
                if "variance" in CLAIMED
            ),
            *([f"{OUT}/figures/psnr_level.png"] if "levels" in CLAIMED else []),
        ],
    output:
        f"{OUT}/reproduction.md",
    log:
        f"{OUT}/logs/reproduction.log",
    params:
        verb="reproduction",
        code=command_code("reproduction"),
        files=lambda wildcards, input, output: [
            *(word for key in CLAIMED for word in [f"--{key}", str(input[key])]),
            *option("--figures", input.figures),
            *("-o", *output),
        ],
        options=["--run", OUT, *RUN.dataset_option],
