from npfm.figures.compared import compared

COMPARED = compared(RUN.variants)


rule figure_of_pictures:
    input:
        psnr=rules.psnr_table.output,
        pictures=RENDERS,
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
        variants=lambda wildcards: " ".join(COMPARED[wildcards.figure]),
    shell:
        "python -m npfm figure {wildcards.figure} --run {OUT} --psnr {input.psnr}"
        " --variants {params.variants} -o {output} 2> {log}"


rule figures_of_pictures:
    input:
        expand(rules.figure_of_pictures.output, figure=COMPARED),
