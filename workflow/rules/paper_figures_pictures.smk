from npfm.figures.compared import LABELS, compared

COMPARED = compared(RUN.variants)


# One rule a figure, for a caption of its own in the report.
for FIGURE, NAMES in COMPARED.items():

    rule:
        name:
            FIGURE
        # The table stands for the pictures: it is made from all of them.
        input:
            rules.psnr_table.output,
        output:
            pdf=f"{OUT}/figures/{FIGURE}.pdf",
            png=report(
                f"{OUT}/figures/{FIGURE}.png",
                caption=f"../report/{FIGURE}.rst",
                category="Figures of the paper",
                labels={"figure": LABELS[FIGURE]},
            ),
        log:
            f"{OUT}/logs/figures/{FIGURE}.log",
        conda:
            "../envs/npfm.yaml"
        resources:
            mem_mb=500,
            runtime=5,
        params:
            code=digest((f"npfm.figures.{FIGURE}",), ("npfm.commands.figure",)),
            arguments=f"{FIGURE} --run {OUT} --variants {' '.join(NAMES)}",
        shell:
            "python -m npfm figure {params.arguments} --psnr {input} -o {output} 2> {log}"


rule figures_of_pictures:
    input:
        expand(f"{OUT}/figures/{{figure}}.{{end}}", figure=COMPARED, end=["pdf", "png"]),
