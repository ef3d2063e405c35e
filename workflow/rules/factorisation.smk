from npfm.run.factorisation import STEPS, TERMS, plan as plan_factorisation

FACTORISATION = plan_factorisation(RUN)


localrules:
    factorisation_table,
    factorisation_figure,


use rule npfm as factorisation_measure with:
    input:
        lambda wildcards: FACTORISATION.source(wildcards.kind, wildcards.source),
    output:
        f"{FACTORISATION.folder}/{{kind}}/{{source}}.csv",
    log:
        f"{OUT}/logs/factorisation/{{kind}}/{{source}}.log",
    wildcard_constraints:
        kind="formulas|materials",
        source=NAME_PATTERN,
    resources:
        mem_mb=2000,
        runtime=20,
    params:
        verb="factorisation measure",
        code=command_code("factorisation measure"),
        files=lambda wildcards, output: [
            *(FACTORISATION.word(wildcards.kind, wildcards.source), "-o", *output)
        ],


use rule npfm as factorisation_table with:
    input:
        FACTORISATION.measured_inputs(),
    output:
        report(
            f"{OUT}/tables/factorisation.csv",
            caption="../report/factorisation.rst",
            category="Importance sampling",
            labels={"result": "factorisation"},
        ),
    log:
        f"{OUT}/logs/factorisation/table.log",
    params:
        verb="factorisation table",
        code=command_code("factorisation table"),
        files=lambda wildcards, input, output: [*words(input), "-o", *output],


use rule npfm as factorisation_factor with:
    input:
        lambda wildcards: FACTORISATION.source(wildcards.kind, wildcards.source),
    output:
        fit=f"{FACTORISATION.folder}/{{kind}}/{{source}}.npz",
        record=f"{FACTORISATION.folder}/{{kind}}/{{source}}.json",
    log:
        f"{OUT}/logs/factorisation/{{kind}}/{{source}}.factor.log",
    wildcard_constraints:
        kind="formulas|materials",
        source=NAME_PATTERN,
    resources:
        mem_mb=2000,
        runtime=20,
    params:
        verb="factor",
        code=command_code("factor"),
        files=lambda wildcards, output: [
            *(FACTORISATION.word(wildcards.kind, wildcards.source), "-o", output.fit)
        ],
        options=lambda wildcards: FACTORISATION.recipe(wildcards.source),


use rule npfm as factorisation_steps with:
    output:
        fit=f"{FACTORISATION.folder}/steps.npz",
        record=f"{FACTORISATION.folder}/steps.json",
    log:
        f"{OUT}/logs/factorisation/steps.log",
    resources:
        mem_mb=1000,
        runtime=15,
    params:
        verb="factor",
        code=command_code("factor"),
        files=lambda wildcards, output: [STEPS[0], "-o", output.fit],
        options=STEPS[1],


use rule npfm as factorisation_terms with:
    output:
        f"{FACTORISATION.folder}/terms.csv",
    log:
        f"{OUT}/logs/factorisation/terms.log",
    resources:
        mem_mb=2000,
        runtime=30,
    params:
        verb="factorisation terms",
        code=command_code("factorisation terms"),
        files=lambda wildcards, output: [TERMS[0], "-o", *output],
        options=TERMS[1],


# By figure: what it is made from, and the words that say so.
FACTORISATION_FIGURES = {
    "factorisation_steps": (
        [rules.factorisation_steps.output.fit],
        ["--brdf", STEPS[0], "--factors", rules.factorisation_steps.output.fit],
    ),
    "factorisation_terms": (
        [*rules.factorisation_terms.output],
        ["--terms", *rules.factorisation_terms.output],
    ),
    "point_light": (FACTORISATION.shown_inputs(), FACTORISATION.shown_options),
}


use rule npfm as factorisation_figure with:
    input:
        lambda wildcards: FACTORISATION_FIGURES[wildcards.figure][0],
    output:
        pdf=f"{OUT}/figures/{{figure}}.pdf",
        png=report(
            f"{OUT}/figures/{{figure}}.png",
            caption="../report/factorisation_figure.rst",
            category="Importance sampling",
            labels={"result": "{figure}"},
        ),
    log:
        f"{OUT}/logs/factorisation/figures/{{figure}}.log",
    wildcard_constraints:
        figure=any_of(FACTORISATION_FIGURES),
    params:
        verb=lambda wildcards: f"figure {wildcards.figure}",
        code=lambda wildcards: command_code(
            "figure", f"npfm.figures.{wildcards.figure}"
        ),
        files=lambda wildcards, output: ["-o", *output],
        options=lambda wildcards: FACTORISATION_FIGURES[wildcards.figure][1],


rule factorisation:
    input:
        rules.factorisation_table.output,
        expand(rules.factorisation_figure.output, figure=FACTORISATION_FIGURES),
