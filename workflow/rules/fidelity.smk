localrules:
    fidelity_figure,


use rule npfm as fidelity_table with:
    input:
        psnr=rules.psnr_table.output,
        measured=expand(rules.material.output, material=RUN.materials),
    output:
        report(
            f"{OUT}/tables/fidelity.csv",
            caption="../report/fidelity.rst",
            category="Tables",
            labels={"table": "PSNR of pictures and of tables"},
        ),
    log:
        f"{OUT}/logs/tables/fidelity.log",
    resources:
        mem_mb=1000,
        runtime=15,
    params:
        verb="tables fidelity",
        code=command_code("tables fidelity", *RUN.model_modules(*RUN.variants)),
        files=lambda wildcards, input, output: [
            *("--run", OUT, "--psnr", *input.psnr),
            *option("--measured", input.measured),
            *("-o", *output),
        ],


use rule npfm as fidelity_figure with:
    input:
        rules.fidelity_table.output,
    output:
        pdf=f"{OUT}/figures/fidelity.pdf",
        png=report(
            f"{OUT}/figures/fidelity.png",
            caption="../report/fidelity.rst",
            category="Figures",
            labels={"figure": "PSNR of pictures and of tables"},
        ),
    log:
        f"{OUT}/logs/figures/fidelity.log",
    params:
        verb="figure fidelity",
        code=command_code("figure", "npfm.figures.fidelity"),
        files=lambda wildcards, input, output: ["--table", *input, "-o", *output],
        options=RUN.colors_option,


rule fidelity:
    input:
        rules.fidelity_table.output,
        rules.fidelity_figure.output,
