# What the page is made from, as far as the run has it: the option of each, and the file.
CLAIMED = {"psnr": rules.psnr_table.output, "summary": rules.summary_table.output}
if "naive" in RUN.variants:
    CLAIMED["materials"] = rules.materials_table.output
if WEIGHTING.columns:
    CLAIMED["weighting"] = rules.weighting_table.output
if "published_factors" in config and "independent-g" in RUN.variants:
    CLAIMED["published"] = f"{OUT}/tables/published.csv"


localrules:
    reproduction,


rule published_table:
    input:
        factors=RUN.user_file(config.get("published_factors", "")),
        tables=expand(rules.material.output, material=RUN.materials),
        fits=expand(
            rules.fit.output.fit, material=RUN.materials, variant="independent-g"
        ),
    output:
        f"{OUT}/tables/published.csv",
    log:
        f"{OUT}/logs/tables/published.log",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=1000,
        runtime=15,
    params:
        code=digest(
            ("npfm.papers.authors_distance", "npfm.papers.authors_factors"),
            ("npfm.commands.tables",),
        ),
        names=MATERIALS,
    shell:
        "python -m npfm tables published {params.names} --factors {input.factors:q}"
        " -o {output} 2> {log}"


rule reproduction:
    input:
        **CLAIMED,
        records=expand(
            rules.fit.output.record,
            material=RUN.materials,
            variant=[name for name in ["independent-g"] if name in RUN.variants],
        ),
        figures=[
            *expand(f"{OUT}/figures/figure08_by_{{order}}.png", order=RUN.orders),
            *expand(
                f"{OUT}/figures/{{figure}}.png", figure=[*FACTOR_FIGURES, *COMPARED]
            ),
        ],
    output:
        f"{OUT}/reproduction.md",
    log:
        f"{OUT}/logs/reproduction.log",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=digest(
            ("npfm.papers.page", "npfm.figures.figure10"),
            ("npfm.commands.reproduction",),
        ),
        names=f"--run {OUT} --dataset {config['dataset']['kind']}",
        tables=lambda wildcards, input: " ".join(
            f"--{option} {input[option]}" for option in CLAIMED
        ),
    shell:
        "python -m npfm reproduction {params.names} {params.tables}"
        " --figures {input.figures} -o {output} 2> {log}"
