from npfm.run.accuracy_cost import plan as plan_accuracy_cost

COST = plan_accuracy_cost(RUN)
COST_CODE = command_code("accuracy-cost")


localrules:
    accuracy_cost_traces,
    accuracy_cost_table,
    accuracy_cost_figure,


use rule fit as accuracy_cost_fit with:
    input:
        table=rules.material.output,
    output:
        fit=f"{COST.folder}/fits/{{variant}}/{{material}}.npz",
        record=f"{COST.folder}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/accuracy_cost/fits/{{variant}}/{{material}}.log",
    params:
        code=lambda wildcards: COST.study.fit_code(wildcards.variant),
        options=lambda wildcards: COST.study.variants[wildcards.variant].options,


use rule npfm as accuracy_cost_traces with:
    input:
        expand(
            "{folder}/{material}.npz",
            folder=COST.traced.values(),
            material=COST.materials,
        ),
    output:
        f"{COST.folder}/traces.csv",
    log:
        f"{OUT}/logs/accuracy_cost/traces.log",
    params:
        verb="accuracy-cost traces",
        code=COST_CODE,
        files=lambda wildcards, output: ["-o", *output],
        options=[
            *option("--fits", map("=".join, COST.traced.items())),
            *option("--materials", COST.materials),
        ],


use rule npfm as accuracy_cost_fits with:
    input:
        table=rules.material.output,
        scenes=expand(rules.scene.output.scene, scene=RUN.scenes),
        fits=lambda wildcards: COST.fits(wildcards.material),
    output:
        f"{COST.folder}/fits/{{material}}.csv",
    log:
        f"{OUT}/logs/accuracy_cost/fits/{{material}}.log",
    resources:
        mem_mb=2500,
        runtime=15,
    params:
        verb="accuracy-cost fits",
        code=command_code(
            "accuracy-cost", *COST.study.model_modules(*COST.study.variants)
        ),
        files=lambda wildcards, input, output: [
            *input.table,
            *option("--scenes", input.scenes),
            *("-o", *output),
        ],
        options=option("--fits", COST.fit_arguments),


use rule scene as accuracy_cost_scene with:
    input:
        light=RUN.light(COST.scene),
        mesh=lambda wildcards: RUN.mesh(COST.scene),
    output:
        scene=directory(f"{COST.folder}/scenes/{{build}}"),
        record=f"{COST.folder}/scenes/{{build}}.json",
    log:
        f"{OUT}/logs/accuracy_cost/scenes/{{build}}.log",
    wildcard_constraints:
        build=any_of(COST.build_names),
    params:
        code=lambda wildcards: COST.scene_code(wildcards.build),
        options=lambda wildcards: COST.scene_options(wildcards.build),


use rule npfm as accuracy_cost_sampling with:
    input:
        reference=COST.reference,
        builds=COST.builds,
        records=[f"{build}.json" for build in COST.builds],
        tables=expand(rules.material.output, material=COST.materials),
        fits=expand(
            "{folder}/{material}.npz", folder=COST.standard, material=COST.materials
        ),
    output:
        f"{COST.folder}/sampling.csv",
    log:
        f"{OUT}/logs/accuracy_cost/sampling.log",
    resources:
        mem_mb=2000,
        runtime=15,
    params:
        verb="accuracy-cost sampling",
        code=command_code("accuracy-cost", *COST.standard_modules),
        files=lambda wildcards, input, output: [
            *("--reference", input.reference),
            *option("--builds", input.builds),
            *option("--tables", input.tables),
            *option("--fits", input.fits),
            *("-o", *output),
        ],


use rule npfm as accuracy_cost_table with:
    input:
        fits=expand(rules.accuracy_cost_fits.output, material=COST.materials),
        sampling=rules.accuracy_cost_sampling.output,
    output:
        report(
            f"{OUT}/tables/accuracy_cost.csv",
            caption="../report/accuracy_cost.rst",
            category="Cost of accuracy",
            labels={"result": "table"},
        ),
    log:
        f"{OUT}/logs/accuracy_cost/table.log",
    params:
        verb="accuracy-cost table",
        code=COST_CODE,
        files=lambda wildcards, input, output: [
            *option("--fits", input.fits),
            *("--sampling", *input.sampling),
            *("-o", *output),
        ],


# By figure: the option that names its tables, and these.
COST_FIGURES = {
    "convergence": ("--traces", rules.accuracy_cost_traces.output),
    "pareto": ("--fits", rules.accuracy_cost_table.input.fits),
    "settings": ("--fits", rules.accuracy_cost_table.input.fits),
    "sampling": ("--sampling", rules.accuracy_cost_sampling.output),
}


use rule npfm as accuracy_cost_figure with:
    input:
        lambda wildcards: COST_FIGURES[wildcards.figure][1],
    output:
        pdf=f"{OUT}/figures/accuracy_cost_{{figure}}.pdf",
        png=report(
            f"{OUT}/figures/accuracy_cost_{{figure}}.png",
            caption="../report/accuracy_cost_figure.rst",
            category="Cost of accuracy",
            labels={"result": "{figure}"},
        ),
    log:
        f"{OUT}/logs/accuracy_cost/figures/{{figure}}.log",
    wildcard_constraints:
        figure=any_of(COST_FIGURES),
    params:
        verb="figure",
        code=lambda wildcards: command_code(
            "figure", f"npfm.figures.{wildcards.figure}"
        ),
        files=lambda wildcards, input, output: [
            *(wildcards.figure, COST_FIGURES[wildcards.figure][0], *words(input)),
            *("-o", *output),
        ],
        options=lambda wildcards: (
            RUN.colors_option if wildcards.figure == "pareto" else []
        ),


rule accuracy_cost:
    input:
        rules.accuracy_cost_table.output,
        expand(rules.accuracy_cost_figure.output, figure=COST_FIGURES),
