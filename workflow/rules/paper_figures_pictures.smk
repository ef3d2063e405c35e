from npfm.figures.compared import compared

COMPARED = compared(RUN.variants)


rule figure_of_pictures:
    # The table stands for the pictures: it is made from all of them.
    input:
        rules.psnr_table.output,
    output:
        pdf=f"{OUT}/figures/{{figure}}.pdf",
        png=f"{OUT}/figures/{{figure}}.png",
    log:
        f"{OUT}/logs/figures/{{figure}}.log",
    wildcard_constraints:
        figure="|".join(COMPARED) or "none",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=lambda wildcards: digest(
            (f"npfm.figures.{wildcards.figure}",), ("npfm.commands.figure",)
        ),
        names=lambda wildcards: (
            f"--run {OUT} --variants {' '.join(COMPARED[wildcards.figure])}"
        ),
    shell:
        "python -m npfm figure {wildcards.figure} {params.names} --psnr {input}"
        " -o {output} 2> {log}"


rule figures_of_pictures:
    input:
        expand(rules.figure_of_pictures.output, figure=COMPARED),
