from npfm.evaluation.quality import METRICS


localrules:
    figure08,
    figure08_by_metric,
    table1,


use rule npfm as figure08 with:
    input:
        psnr=rules.psnr_table.output,
        materials=lambda wildcards: (
            rules.materials_table.output if wildcards.order == "diffuseness" else []
        ),
    output:
        pdf=f"{OUT}/figures/figure08_by_{{order}}.pdf",
        png=report(
            f"{OUT}/figures/figure08_by_{{order}}.png",
            caption="../report/figure08.rst",
            category="Figures of the paper",
            labels={"figure": "8: PSNR of all materials, by {order}"},
        ),
    log:
        f"{OUT}/logs/figures/figure08_by_{{order}}.log",
    wildcard_constraints:
        order="diffuseness|error",
    params:
        verb="figure figure08",
        code=command_code("figure", "npfm.figures.figure08"),
        files=lambda wildcards, input, output: [
            *("--psnr", *input.psnr),
            *option("--materials", input.materials),
            *("-o", *output),
        ],
        options=lambda wildcards: ["--order", wildcards.order, *RUN.colors_option],


# Figure 8 by any of the metrics, for whoever asks for the file.
use rule figure08 as figure08_by_metric with:
    input:
        quality=rules.quality_table.output,
        materials=lambda wildcards: (
            rules.materials_table.output if wildcards.order == "diffuseness" else []
        ),
    output:
        pdf=f"{OUT}/figures/figure08_{{metric}}_by_{{order}}.pdf",
        png=f"{OUT}/figures/figure08_{{metric}}_by_{{order}}.png",
    log:
        f"{OUT}/logs/figures/figure08_{{metric}}_by_{{order}}.log",
    wildcard_constraints:
        order="diffuseness|error",
        metric=any_of(METRICS),
    params:
        files=lambda wildcards, input, output: [
            *("--quality", *input.quality),
            *option("--materials", input.materials),
            *("-o", *output),
        ],
        options=lambda wildcards: [
            *("--metric", wildcards.metric, "--order", wildcards.order),
            *RUN.colors_option,
        ],


use rule npfm as table1 with:
    input:
        rules.fits_table.output,
    output:
        report(
            f"{OUT}/figures/table1.csv",
            caption="../report/table1.rst",
            category="Tables",
            labels={"table": "I: fitting statistics"},
        ),
    log:
        f"{OUT}/logs/figures/table1.log",
    params:
        verb="tables table1",
        code=TABLES_CODE,
        files=lambda wildcards, input, output: ["--fits", *input, "-o", *output],


rule figures:
    input:
        expand(rules.figure08.output, order=RUN.orders),
        rules.table1.output,
        rules.paper_figures.input,


use rule npfm as page with:
    input:
        pictures=lambda wildcards: expand(
            f"{OUT}/renders/{{scene}}/{wildcards.material}/{{variant}}.png",
            scene=RUN.scenes,
            variant=["measured", *RUN.variants_of(wildcards.material)],
        ),
        psnr=rules.psnr_table.output,
    output:
        report(
            f"{OUT}/figures/pages/{{material}}.png",
            caption="../report/page.rst",
            category="Renderings",
            labels={"material": "{material}"},
        ),
    log:
        f"{OUT}/logs/figures/pages/{{material}}.log",
    resources:
        mem_mb=500,
        runtime=5,
    params:
        verb="figure page",
        code=command_code("figure", "npfm.figures.page"),
        files=lambda wildcards, input, output: ["--psnr", *input.psnr, "-o", *output],
        options=lambda wildcards: [
            *("--run", OUT, "--material", wildcards.material),
            *("--scenes", *RUN.scenes),
            *("--variants", *RUN.variants_of(wildcards.material)),
        ],


rule pages:
    input:
        expand(rules.page.output, material=RUN.materials),
