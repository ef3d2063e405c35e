from npfm.run import weighting
from npfm.run.paper_figures import drawn

WEIGHTING = weighting.plan(RUN)
FACTOR_FIGURES = drawn(RUN, WEIGHTING)


localrules:
    weighting_table,
    texture,


use rule fit as weighting_fit with:
    input:
        table=rules.material.output,
    output:
        fit=f"{WEIGHTING.folder}/fits/{{variant}}/{{material}}.npz",
        record=f"{WEIGHTING.folder}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/weighting/fits/{{variant}}/{{material}}.log",
    params:
        code=lambda wildcards: WEIGHTING.study.fit_code(wildcards.variant),
        options=lambda wildcards: WEIGHTING.study.variants[wildcards.variant].options,


use rule render_fit as weighting_render with:
    input:
        scene=rules.scene.output.scene,
        fit=rules.weighting_fit.output.fit,
        table=rules.material.output,
    wildcard_constraints:
        variant="|".join(WEIGHTING.added) or "none",
    params:
        code=lambda wildcards: WEIGHTING.study.render_code(wildcards.variant),
        tone=lambda wildcards: RUN.tone(wildcards.scene),


ruleorder: weighting_render > render_fit


rule weighting_table:
    input:
        expand(
            f"{OUT}/renders/{{scene}}/{{material}}/{{variant}}.exr",
            scene=RUN.scenes,
            material=WEIGHTING.all_materials,
            variant=["measured", *WEIGHTING.all_pictures],
        ),
    output:
        report(
            f"{OUT}/tables/weighting.csv",
            caption="../report/weighting.rst",
            category="Tables",
            labels={"table": "PSNR with and without compressive weighting"},
        ),
    log:
        f"{OUT}/logs/tables/weighting.log",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=TABLES_CODE,
        names=f"--run {OUT} --materials {' '.join(WEIGHTING.all_materials)}"
        f" --variants {' '.join(WEIGHTING.all_pictures)} --scenes {' '.join(RUN.scenes)}",
    shell:
        "python -m npfm tables psnr {params.names} -o {output} 2> {log}"


# One rule a figure, for a caption of its own in the report.
for FIGURE, DRAWN in FACTOR_FIGURES.items():

    rule:
        name:
            FIGURE
        input:
            DRAWN.files,
        output:
            pdf=f"{OUT}/figures/{FIGURE}.pdf",
            png=report(
                f"{OUT}/figures/{FIGURE}.png",
                caption=f"../report/{FIGURE}.rst",
                category="Figures of the paper",
                labels={"figure": DRAWN.label},
            ),
        log:
            f"{OUT}/logs/figures/{FIGURE}.log",
        conda:
            "../envs/npfm.yaml"
        resources:
            mem_mb=1000,
            runtime=5,
        params:
            code=digest((f"npfm.figures.{FIGURE}",), ("npfm.commands.figure",)),
            arguments=f"{FIGURE} {DRAWN.arguments}",
        shell:
            "python -m npfm figure {params.arguments} -o {output} 2> {log}"


rule texture:
    input:
        FACTOR_FIGURES["figure16"].files if "figure16" in FACTOR_FIGURES else [],
    output:
        f"{OUT}/figures/figure16.exr",
    log:
        f"{OUT}/logs/figures/texture.log",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=digest(
            ("npfm.exports.texture", "npfm.storage.pictures"),
            ("npfm.commands.texture",),
        ),
    shell:
        "python -m npfm texture {input} -o {output} 2> {log}"


rule figures_of_factors:
    input:
        expand(
            f"{OUT}/figures/{{figure}}.{{end}}",
            figure=FACTOR_FIGURES,
            end=["pdf", "png"],
        ),
        rules.texture.output if "figure16" in FACTOR_FIGURES else [],
