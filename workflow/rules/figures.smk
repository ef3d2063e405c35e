localrules:
    figure08,
    table1,


rule figure08:
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
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=digest(("npfm.figures.figure08",), ("npfm.commands.figure",)),
        materials=lambda wildcards, input: (
            f"--materials {input.materials}" if input.materials else ""
        ),
        colors=RUN.colors_option,
    shell:
        "python -m npfm figure figure08 --psnr {input.psnr} {params.materials}"
        " --order {wildcards.order} {params.colors} -o {output.pdf} {output.png} 2> {log}"


rule table1:
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
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=TABLES_CODE,
    shell:
        "python -m npfm tables table1 --fits {input} -o {output} 2> {log}"


rule figures:
    input:
        expand(rules.figure08.output, order=RUN.orders),
        rules.table1.output,
        rules.figures_of_factors.input,
        rules.figures_of_pictures.input,


rule page:
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
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
        runtime=5,
    params:
        code=digest(("npfm.figures.page",), ("npfm.commands.figure",)),
        names=f"--run {OUT} --scenes {' '.join(RUN.scenes)}",
        variants=lambda wildcards: " ".join(RUN.variants_of(wildcards.material)),
    shell:
        "python -m npfm figure page {params.names} --variants {params.variants}"
        " --material {wildcards.material} --psnr {input.psnr} -o {output} 2> {log}"


rule pages:
    input:
        expand(rules.page.output, material=RUN.materials),
