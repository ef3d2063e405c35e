localrules:
    where_figure,


use rule npfm as where_table with:
    input:
        [RUN.table(material) for material in RUN.materials],
        [f"{OUT}/fits/{variant}/{material}.npz" for material, variant in RUN.fits],
        [
            f"{OUT}/renders/{scene}/{material}/{variant}.exr"
            for scene in RUN.spheres
            for material in RUN.materials
            for variant in ["measured", *RUN.variants_of(material)]
        ],
    output:
        report(
            f"{OUT}/tables/where.csv",
            caption="../report/where.rst",
            category="Tables",
            labels={"table": "where the error of fits sits"},
        ),
    log:
        f"{OUT}/logs/tables/where.log",
    resources:
        mem_mb=1000,
        runtime=15,
    params:
        verb="tables where",
        code=command_code("tables where", *RUN.model_modules(*RUN.variants)),
        files=lambda wildcards, output: ["--run", OUT, "-o", *output],
        options=[
            *option("--materials", RUN.materials),
            *option("--variants", RUN.variants),
            *RUN.missing_option,
            *RUN.where_options,
        ],


use rule npfm as where_figure with:
    input:
        rules.where_table.output,
    output:
        pdf=f"{OUT}/figures/where.pdf",
        png=report(
            f"{OUT}/figures/where.png",
            caption="../report/where.rst",
            category="Figures",
            labels={"figure": "where the error of fits sits"},
        ),
    log:
        f"{OUT}/logs/figures/where.log",
    params:
        verb="figure where",
        code=command_code("figure", "npfm.figures.where"),
        files=lambda wildcards, input, output: ["--table", *input, "-o", *output],
        options=RUN.colors_option,


rule where:
    input:
        rules.where_table.output,
        rules.where_figure.output,
