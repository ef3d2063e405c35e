from npfm.run.accuracy_cost import plan

COST = plan(RUN)
COST_TABLES = digest(
    ("npfm.evaluation.accuracy_cost",), ("npfm.commands.accuracy_cost",)
)


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


rule accuracy_cost_traces:
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
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=COST_TABLES,
        fits=" ".join(f"{solver}={folder}" for solver, folder in COST.traced.items()),
        materials=" ".join(COST.materials),
    shell:
        "python -m npfm accuracy-cost traces --fits {params.fits} --materials {params.materials}"
        " -o {output} 2> {log}"


rule accuracy_cost_fits:
    input:
        table=rules.material.output,
        scenes=expand(rules.scene.output.scene, scene=RUN.scenes),
        fits=lambda wildcards: COST.fits(wildcards.material),
    output:
        f"{COST.folder}/fits/{{material}}.csv",
    log:
        f"{OUT}/logs/accuracy_cost/fits/{{material}}.log",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=2500,
        runtime=15,
    params:
        code=COST_TABLES,
        render=sorted(
            {COST.study.render_code(variant) for variant in COST.study.variants}
        ),
        fits=COST.fit_arguments,
    shell:
        "python -m npfm accuracy-cost fits {input.table} --scenes {input.scenes}"
        " --fits {params.fits} -o {output} 2> {log}"


rule accuracy_cost_scene:
    input:
        light=f"{OUT}/lights/{config['scenes'][COST.scene]['light']}.exr",
        mesh=RUN.mesh(COST.scene),
    output:
        scene=directory(f"{COST.folder}/scenes/{{build}}"),
        record=f"{COST.folder}/scenes/{{build}}.json",
    log:
        f"{OUT}/logs/accuracy_cost/scenes/{{build}}.log",
    wildcard_constraints:
        build="[^/.]+",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=3000,
        runtime=20,
    params:
        code=lambda wildcards: COST.scene_code(wildcards.build),
        options=lambda wildcards: COST.scene_options(wildcards.build),
    shell:
        "python -m npfm scene --light {input.light} {params.options}"
        " --record {output.record} -o {output.scene} 2> {log}"


rule accuracy_cost_sampling:
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
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=2000,
        runtime=15,
    params:
        code=COST_TABLES,
        render=COST.study.render_code("model-independent-g-gauss-newton"),
    shell:
        "python -m npfm accuracy-cost sampling --reference {input.reference}"
        " --builds {input.builds} --tables {input.tables} --fits {input.fits}"
        " -o {output} 2> {log}"


rule accuracy_cost_table:
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
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=COST_TABLES,
    shell:
        "python -m npfm accuracy-cost table --fits {input.fits} --sampling {input.sampling}"
        " -o {output} 2> {log}"


# By figure: the option that names its tables, and these.
COST_FIGURES = {
    "convergence": ("--traces", rules.accuracy_cost_traces.output),
    "pareto": ("--fits", rules.accuracy_cost_table.input.fits),
    "settings": ("--fits", rules.accuracy_cost_table.input.fits),
    "sampling": ("--sampling", rules.accuracy_cost_sampling.output),
}


rule accuracy_cost_figure:
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
        figure="|".join(COST_FIGURES),
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=lambda wildcards: digest(
            (f"npfm.figures.{wildcards.figure}",), ("npfm.commands.figure",)
        ),
        option=lambda wildcards: COST_FIGURES[wildcards.figure][0],
        colors=lambda wildcards: (
            RUN.colors_option if wildcards.figure == "pareto" else ""
        ),
    shell:
        "python -m npfm figure {wildcards.figure} {params.option} {input}"
        " {params.colors} -o {output} 2> {log}"


rule accuracy_cost:
    input:
        rules.accuracy_cost_table.output,
        expand(rules.accuracy_cost_figure.output, figure=COST_FIGURES),
