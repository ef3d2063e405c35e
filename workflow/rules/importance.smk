from npfm.papers import lawrence2004
from npfm.run.importance import plan as plan_importance

IMPORTANCE = plan_importance(RUN)


localrules:
    importance_table,
    importance_figure,


use rule npfm as importance_formula with:
    output:
        f"{IMPORTANCE.folder}/formulas/{{formula}}.binary",
    log:
        f"{OUT}/logs/importance/formulas/{{formula}}.log",
    wildcard_constraints:
        formula=any_of(IMPORTANCE.formulas),
    resources:
        mem_mb=800,
        runtime=10,
    params:
        verb="material",
        code=command_code("material formula"),
        files=lambda wildcards, output: ["-o", *output],
        options=lambda wildcards: ["--formula", wildcards.formula],


use rule fit as importance_fit with:
    input:
        table=lambda wildcards: [IMPORTANCE.table(wildcards.material)],
    output:
        fit=f"{IMPORTANCE.folder}/fits/{{variant}}/{{material}}.npz",
        record=f"{IMPORTANCE.folder}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/importance/fits/{{variant}}/{{material}}.log",
    params:
        code=lambda wildcards: IMPORTANCE.study.fit_code(wildcards.variant),
        options=lambda wildcards: IMPORTANCE.study.variants[wildcards.variant].options,


use rule npfm as importance_measure with:
    input:
        table=lambda wildcards: [IMPORTANCE.table(wildcards.material)],
        light=rules.light.output,
        fits=lambda wildcards: IMPORTANCE.fits(wildcards.material),
    output:
        table=f"{IMPORTANCE.folder}/{{light}}/{{material}}.csv",
        images=f"{IMPORTANCE.folder}/{{light}}/{{material}}.exr",
    log:
        f"{OUT}/logs/importance/{{light}}/{{material}}.log",
    wildcard_constraints:
        light=any_of(IMPORTANCE.lights),
        material=any_of([*IMPORTANCE.materials, *IMPORTANCE.formulas]),
    resources:
        mem_mb=1500,
        runtime=20,
    params:
        verb="importance measure",
        code=command_code("importance measure", *IMPORTANCE.modules),
        files=lambda wildcards, input, output: [
            *(*input.table, "--light", *input.light),
            *("-o", output.table, "--images", output.images),
        ],
        options=lambda wildcards: [
            *IMPORTANCE.effort_options,
            *option("--parameters", IMPORTANCE.parameters(wildcards.material)),
        ],


use rule npfm as importance_table with:
    input:
        expand(
            rules.importance_measure.output.table,
            light=IMPORTANCE.lights,
            material=[*IMPORTANCE.materials, *IMPORTANCE.formulas],
        ),
    output:
        report(
            f"{OUT}/tables/variance.csv",
            caption="../report/importance.rst",
            category="Importance sampling",
            labels={"result": "variance"},
        ),
    log:
        f"{OUT}/logs/importance/table.log",
    params:
        verb="importance table",
        code=command_code("importance table"),
        files=lambda wildcards, input, output: [*words(input), "-o", *output],


# By figure: what draws it, what it is made from beside the table, and the words that say so.
IMPORTANCE_FIGURES = {
    "single": ("importance", [], ["--points", "independent"]),
    "stratified": ("importance", [], ["--points", "sobol"]),
    "improvement": ("improvement", [], ["--strategies", *lawrence2004.STRATEGIES]),
    "samples": ("variance_samples", [], ["--materials", *IMPORTANCE.shown]),
    "images": (
        "variance_images",
        IMPORTANCE.images,
        IMPORTANCE.images_options,
    ),
    "estimators": ("estimators", [], []),
}


use rule npfm as importance_figure with:
    input:
        table=rules.importance_table.output,
        more=lambda wildcards: IMPORTANCE_FIGURES[wildcards.figure][1],
    output:
        pdf=f"{OUT}/figures/importance_{{figure}}.pdf",
        png=report(
            f"{OUT}/figures/importance_{{figure}}.png",
            caption="../report/importance_figure.rst",
            category="Importance sampling",
            labels={"result": "{figure}"},
        ),
    log:
        f"{OUT}/logs/importance/figures/{{figure}}.log",
    wildcard_constraints:
        figure=any_of(IMPORTANCE_FIGURES),
    params:
        verb=lambda wildcards: f"figure {IMPORTANCE_FIGURES[wildcards.figure][0]}",
        code=lambda wildcards: command_code(
            "figure", f"npfm.figures.{IMPORTANCE_FIGURES[wildcards.figure][0]}"
        ),
        files=lambda wildcards, input, output: [
            *([] if wildcards.figure == "images" else ["--table", *input.table]),
            *("-o", *output),
        ],
        options=lambda wildcards: IMPORTANCE_FIGURES[wildcards.figure][2],


rule importance:
    input:
        rules.importance_table.output,
        expand(rules.importance_figure.output, figure=IMPORTANCE_FIGURES),
