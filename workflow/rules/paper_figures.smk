from npfm.run import weighting
from npfm.run.paper_figures import drawn

WEIGHTING = weighting.plan(RUN)
DRAWN = drawn(RUN, WEIGHTING)


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


use rule bounced_fit as weighting_bounced with:
    input:
        fit=rules.weighting_fit.output.fit,
        table=rules.material.output,
        light=lambda wildcards: RUN.light(wildcards.scene),
        mesh=lambda wildcards: RUN.mesh(wildcards.scene),
    wildcard_constraints:
        variant=any_of(WEIGHTING.added),
    params:
        code=lambda wildcards: WEIGHTING.study.bounced_code(wildcards.variant),


ruleorder: weighting_bounced > bounced_fit


use rule render_fit as weighting_render with:
    input:
        scenes=expand(rules.scene.output.scene, scene=SCENES),
        fit=rules.weighting_fit.output.fit,
        table=rules.material.output,
        bounced=lambda wildcards: RUN.bounced(wildcards),
    wildcard_constraints:
        variant=any_of(WEIGHTING.added),
    params:
        code=lambda wildcards: WEIGHTING.study.render_code(wildcards.variant),


ruleorder: weighting_render > render_fit


use rule psnr_table as weighting_table with:
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
    params:
        options=[
            *("--run", OUT),
            *option("--materials", WEIGHTING.all_materials),
            *option("--variants", WEIGHTING.all_pictures),
            *option("--scenes", RUN.scenes),
        ],


# One rule a figure, for a caption of its own in the report.
for FIGURE, HOW in DRAWN.items():

    rule:
        name:
            FIGURE
        input:
            HOW.files,
        output:
            pdf=f"{OUT}/figures/{FIGURE}.pdf",
            png=report(
                f"{OUT}/figures/{FIGURE}.png",
                caption=f"../report/{FIGURE}.rst",
                category="Figures of the paper",
                labels={"figure": HOW.label},
            ),
        log:
            f"{OUT}/logs/figures/{FIGURE}.log",
        localrule: True
        conda:
            lambda wildcards: ENVIRONMENT
        resources:
            mem_mb=1000,
        params:
            figure=FIGURE,
            code=command_code("figure", f"npfm.figures.{FIGURE}", *HOW.models),
            arguments=lambda wildcards, how=HOW: how.arguments,
        shell:
            "python -m npfm figure {params.figure} {params.arguments:q} -o {output:q} 2> {log:q}"


use rule npfm as texture with:
    input:
        DRAWN["figure16"].files if "figure16" in DRAWN else [],
    output:
        f"{OUT}/figures/figure16.exr",
    log:
        f"{OUT}/logs/figures/texture.log",
    params:
        verb="texture",
        code=command_code("texture"),
        files=lambda wildcards, input, output: [*words(input), "-o", *output],


rule paper_figures:
    input:
        expand(f"{OUT}/figures/{{figure}}.{{end}}", figure=DRAWN, end=["pdf", "png"]),
        rules.texture.output if "figure16" in DRAWN else [],
