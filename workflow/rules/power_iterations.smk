from npfm.run.power_iterations import FACTORS, MODEL, plan as plan_power_iterations

POWER = plan_power_iterations(RUN)
POWER_CODE = command_code("power-iterations")


localrules:
    power_iterations_known,
    power_iterations_surfaces,
    power_iterations_figure,


use rule fit as power_iterations_fit with:
    input:
        table=rules.material.output,
    output:
        fit=f"{POWER.folder}/fits/{{variant}}/{{material}}.npz",
        record=f"{POWER.folder}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/power_iterations/fits/{{variant}}/{{material}}.log",
    params:
        code=lambda wildcards: POWER.study.fit_code(wildcards.variant),
        options=lambda wildcards: POWER.study.variants[wildcards.variant].options,


use rule bounced_fit as power_iterations_bounced with:
    input:
        fit=rules.power_iterations_fit.output.fit,
        table=rules.material.output,
        light=lambda wildcards: RUN.light(wildcards.scene),
        mesh=lambda wildcards: RUN.mesh(wildcards.scene),
    output:
        exr=f"{POWER.folder}/bounced/{{scene}}/{{material}}/{{variant}}.exr",
        record=f"{POWER.folder}/bounced/{{scene}}/{{material}}/{{variant}}.json",
    log:
        f"{OUT}/logs/power_iterations/bounced/{{scene}}/{{material}}/{{variant}}.log",
    params:
        code=lambda wildcards: POWER.study.bounced_code(wildcards.variant),


use rule render_fit as power_iterations_render with:
    input:
        scenes=expand(rules.scene.output.scene, scene=SCENES),
        fit=rules.power_iterations_fit.output.fit,
        table=rules.material.output,
        bounced=lambda wildcards: RUN.bounced(wildcards, POWER.folder),
    output:
        exr=expand(
            f"{POWER.folder}/renders/{{scene}}/{{{{material}}}}/{{{{variant}}}}.exr",
            scene=SCENES,
        ),
        png=expand(
            f"{POWER.folder}/renders/{{scene}}/{{{{material}}}}/{{{{variant}}}}.png",
            scene=SCENES,
        ),
    log:
        f"{OUT}/logs/power_iterations/render/{{material}}/{{variant}}.log",
    params:
        code=lambda wildcards: POWER.study.render_code(wildcards.variant),


use rule npfm as power_iterations_edit with:
    input:
        f"{POWER.home(MODEL)}/fits/{MODEL}/{{material}}.npz",
    output:
        fit=f"{POWER.folder}/edited/{{material}}/{{factor}}.npz",
        record=f"{POWER.folder}/edited/{{material}}/{{factor}}.json",
    log:
        f"{OUT}/logs/power_iterations/edited/{{material}}/{{factor}}.log",
    wildcard_constraints:
        factor=any_of(FACTORS),
    # Between the fit and its pictures, which are in this group.
    group:
        "material"
    resources:
        mem_mb=500,
        runtime=5,
    params:
        verb="edit",
        code=command_code("edit", *POWER.study.model_modules(MODEL)),
        files=lambda wildcards, input, output: [*input, "-o", output.fit],
        options=lambda wildcards: ["--roughness", wildcards.factor],


use rule render_fit as power_iterations_render_edited with:
    input:
        scenes=[f"{OUT}/scenes/{POWER.scene}"],
        fit=rules.power_iterations_edit.output.fit,
        table=rules.material.output,
    output:
        exr=f"{POWER.folder}/edited/{{material}}/{{factor}}.exr",
        png=f"{POWER.folder}/edited/{{material}}/{{factor}}.png",
    log:
        f"{OUT}/logs/power_iterations/render/edited/{{material}}/{{factor}}.log",
    wildcard_constraints:
        factor=any_of(FACTORS),
    params:
        code=POWER.study.render_code(MODEL),
        options=RUN.tone_options(POWER.scene),


use rule npfm as power_iterations_vary with:
    input:
        scene=f"{OUT}/scenes/{POWER.scene}",
        fits=expand(
            f"{POWER.folder}/edited/{{{{material}}}}/{{factor}}.npz", factor=FACTORS
        ),
    output:
        exr=f"{POWER.folder}/edited/{{material}}/textured.exr",
        png=f"{POWER.folder}/edited/{{material}}/textured.png",
    log:
        f"{OUT}/logs/power_iterations/render/edited/{{material}}/textured.log",
    resources:
        mem_mb=2000,
        runtime=5,
    params:
        verb="vary",
        code=command_code("vary", *POWER.study.model_modules(MODEL)),
        files=lambda wildcards, input, output: [
            *(input.scene, *input.fits),
            *("-o", output.exr),
        ],
        options=[*POWER.objects_options, *RUN.tone_options(POWER.scene)],


use rule npfm as power_iterations_known with:
    output:
        report(
            f"{OUT}/tables/power_iterations_{{kind}}.csv",
            caption="../report/power_iterations.rst",
            category="Power iterations",
            labels={"result": "{kind}"},
        ),
    log:
        f"{OUT}/logs/power_iterations/{{kind}}.log",
    wildcard_constraints:
        kind="recovery|timing",
    resources:
        mem_mb=2000,
    params:
        verb=lambda wildcards: f"power-iterations {wildcards.kind}",
        code=POWER_CODE,
        files=lambda wildcards, output: ["-o", *output],
        options=POWER.known_options,


use rule npfm as power_iterations_surfaces with:
    input:
        POWER.told,
    output:
        report(
            f"{OUT}/tables/power_iterations_surfaces.csv",
            caption="../report/power_iterations.rst",
            category="Power iterations",
            labels={"result": "surfaces"},
        ),
    log:
        f"{OUT}/logs/power_iterations/surfaces.log",
    params:
        verb="power-iterations surfaces",
        code=POWER_CODE,
        files=lambda wildcards, input, output: [*words(input), "-o", *output],


use rule npfm as power_iterations_delta_e with:
    input:
        measured=expand(
            f"{POWER.measured}/{{material}}/measured.{{end}}",
            material=RUN.materials,
            end=["exr", "png"],
        ),
        fits=POWER.compared,
    output:
        table=f"{OUT}/tables/power_iterations_delta_e.csv",
        images=f"{POWER.folder}/delta_e.exr",
    log:
        f"{OUT}/logs/power_iterations/delta_e.log",
    resources:
        mem_mb=1000,
        runtime=15,
    params:
        verb="power-iterations delta-e",
        code=POWER_CODE,
        files=lambda wildcards, output: [
            *("-o", output.table),
            *("--images", output.images),
        ],
        options=[
            *("--measured", POWER.measured),
            *option("--fits", POWER.fit_options),
            *option("--materials", RUN.materials),
        ],


# By figure: what it is made from, and the words that say so.
POWER_FIGURES = {
    "delta_e": (
        rules.power_iterations_delta_e.output,
        [
            *("--images", rules.power_iterations_delta_e.output.images),
            *("--table", rules.power_iterations_delta_e.output.table),
        ],
    ),
    "extraction_time": (
        [f"{OUT}/tables/power_iterations_timing.csv"],
        ["--timing", f"{OUT}/tables/power_iterations_timing.csv"],
    ),
    "side_by_side": (
        [rules.power_iterations_delta_e.output.table],
        [
            *("--measured", POWER.measured),
            *option("--fits", POWER.fit_options),
            *option("--materials", POWER.shown),
            *("--table", rules.power_iterations_delta_e.output.table),
        ],
    ),
    "roughness": (
        [
            *rules.power_iterations_surfaces.output,
            *expand(
                rules.power_iterations_render_edited.output.png,
                material=POWER.edited,
                factor=FACTORS,
            ),
            *expand(rules.power_iterations_vary.output.png, material=POWER.edited),
        ],
        [
            *("--pictures", f"{POWER.folder}/edited"),
            *option("--materials", POWER.edited),
            *option("--factors", [*FACTORS, "textured"]),
            *("--surfaces", *rules.power_iterations_surfaces.output),
        ],
    ),
}


use rule npfm as power_iterations_figure with:
    input:
        lambda wildcards: POWER_FIGURES[wildcards.figure][0],
    output:
        pdf=f"{OUT}/figures/power_iterations_{{figure}}.pdf",
        png=report(
            f"{OUT}/figures/power_iterations_{{figure}}.png",
            caption="../report/power_iterations_figure.rst",
            category="Power iterations",
            labels={"result": "{figure}"},
        ),
    log:
        f"{OUT}/logs/power_iterations/figures/{{figure}}.log",
    wildcard_constraints:
        figure=any_of(POWER_FIGURES),
    params:
        verb=lambda wildcards: f"figure {wildcards.figure}",
        code=lambda wildcards: command_code(
            "figure", f"npfm.figures.{wildcards.figure}"
        ),
        files=lambda wildcards, output: ["-o", *output],
        options=lambda wildcards: POWER_FIGURES[wildcards.figure][1],


rule power_iterations:
    input:
        expand(
            f"{OUT}/tables/power_iterations_{{table}}.csv",
            table=["recovery", "timing", "surfaces", "delta_e"],
        ),
        expand(rules.power_iterations_figure.output, figure=POWER_FIGURES),
