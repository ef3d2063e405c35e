from npfm.run.shared_lobes import MODEL as LOBES_MODEL, plan as plan_shared_lobes

LOBES = plan_shared_lobes(RUN)


localrules:
    shared_lobes_table,
    shared_lobes_errors,
    shared_lobes_figure,


use rule fit as shared_lobes_fit with:
    input:
        table=rules.material.output,
    output:
        fit=f"{LOBES.folder}/fits/{{variant}}/{{material}}.npz",
        record=f"{LOBES.folder}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/shared_lobes/fits/{{variant}}/{{material}}.log",
    params:
        code=lambda wildcards: LOBES.study.fit_code(wildcards.variant),
        options=lambda wildcards: LOBES.study.variants[wildcards.variant].options,


use rule npfm as shared_lobes_compare with:
    input:
        table=rules.material.output,
        scenes=expand(rules.scene.output.scene, scene=LOBES.scenes),
        fits=lambda wildcards: LOBES.fits(wildcards.material),
    output:
        f"{LOBES.folder}/compared/{{material}}.csv",
    log:
        f"{OUT}/logs/shared_lobes/compared/{{material}}.log",
    resources:
        mem_mb=2500,
        runtime=15,
    params:
        verb="accuracy-cost fits",
        code=command_code("accuracy-cost", *LOBES.modules),
        files=lambda wildcards, input, output: [
            *input.table,
            *option("--scenes", input.scenes),
            *("-o", *output),
        ],
        options=lambda wildcards: option(
            "--fits", map("=".join, LOBES.settings(wildcards.material).items())
        ),


use rule npfm as shared_lobes_table with:
    input:
        lambda wildcards: expand(
            rules.shared_lobes_compare.output,
            material=LOBES.counted if wildcards.table == "lobes" else RUN.materials,
        ),
    output:
        report(
            f"{OUT}/tables/shared_lobes_{{table}}.csv",
            caption="../report/shared_lobes.rst",
            category="Shared lobes",
            labels={"result": "{table}"},
        ),
    log:
        f"{OUT}/logs/shared_lobes/{{table}}.log",
    wildcard_constraints:
        table="psnr|lobes",
    params:
        verb=lambda wildcards: f"shared-lobes {wildcards.table}",
        code=command_code("shared-lobes"),
        files=lambda wildcards, input, output: [*words(input), "-o", *output],


use rule npfm as shared_lobes_sampling with:
    input:
        fit=lambda wildcards: LOBES.fit(LOBES_MODEL, wildcards.material),
        light=LOBES.light,
    output:
        f"{LOBES.folder}/sampling/{{material}}.csv",
    log:
        f"{OUT}/logs/shared_lobes/sampling/{{material}}.log",
    resources:
        mem_mb=2000,
        runtime=30,
    params:
        verb="shared-lobes sampling",
        code=LOBES.sampling_code,
        files=lambda wildcards, input, output: [
            *(input.fit, "--light", input.light),
            *("-o", *output),
        ],
        options=LOBES.effort_options,


use rule npfm as shared_lobes_errors with:
    input:
        expand(rules.shared_lobes_sampling.output, material=LOBES.sampled),
    output:
        report(
            f"{OUT}/tables/shared_lobes_sampling.csv",
            caption="../report/shared_lobes.rst",
            category="Shared lobes",
            labels={"result": "sampling"},
        ),
    log:
        f"{OUT}/logs/shared_lobes/sampling.log",
    params:
        verb="shared-lobes gather",
        code=command_code("shared-lobes"),
        files=lambda wildcards, input, output: [*words(input), "-o", *output],


# By figure: what it is made from, and the option that names it.
LOBES_FIGURES = {
    "psnr": ([f"{OUT}/tables/shared_lobes_psnr.csv"], "--psnr"),
    "factors": ([LOBES.fit(LOBES_MODEL, name) for name in LOBES.shown], "--fits"),
    "sampling": (list(rules.shared_lobes_errors.output), "--sampling"),
}


use rule npfm as shared_lobes_figure with:
    input:
        lambda wildcards: LOBES_FIGURES[wildcards.figure][0],
    output:
        pdf=f"{OUT}/figures/shared_lobes_{{figure}}.pdf",
        png=report(
            f"{OUT}/figures/shared_lobes_{{figure}}.png",
            caption="../report/shared_lobes_figure.rst",
            category="Shared lobes",
            labels={"result": "{figure}"},
        ),
    log:
        f"{OUT}/logs/shared_lobes/figures/{{figure}}.log",
    wildcard_constraints:
        figure=any_of(LOBES_FIGURES),
    params:
        verb=lambda wildcards: f"figure shared_lobes_{wildcards.figure}",
        code=lambda wildcards: command_code(
            "figure", f"npfm.figures.shared_lobes_{wildcards.figure}"
        ),
        files=lambda wildcards, output: ["-o", *output],
        options=lambda wildcards: [
            *option(*reversed(LOBES_FIGURES[wildcards.figure])),
            *(RUN.colors_option if wildcards.figure == "psnr" else []),
        ],


rule shared_lobes:
    input:
        expand(
            f"{OUT}/tables/shared_lobes_{{table}}.csv",
            table=["psnr", "lobes", "sampling"],
        ),
        expand(rules.shared_lobes_figure.output, figure=LOBES_FIGURES),
