from npfm.run.uniqueness import plan as plan_uniqueness

UNIQUENESS = plan_uniqueness(RUN)


localrules:
    uniqueness_table,
    uniqueness_summary,
    uniqueness_figure,


use rule fit as uniqueness_fit with:
    input:
        table=rules.material.output,
    output:
        fit=f"{UNIQUENESS.folder}/fits/{{variant}}/{{material}}.npz",
        record=f"{UNIQUENESS.folder}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/uniqueness/fits/{{variant}}/{{material}}.log",
    params:
        code=lambda wildcards: UNIQUENESS.study.fit_code(wildcards.variant),
        options=lambda wildcards: UNIQUENESS.study.variants[wildcards.variant].options,


use rule fit as uniqueness_starts with:
    input:
        table=rules.material.output,
    output:
        fit=f"{UNIQUENESS.folder}/starts/{{material}}.npz",
        record=f"{UNIQUENESS.folder}/starts/{{material}}.json",
        iterations=f"{UNIQUENESS.folder}/iterations/{{material}}.npz",
    log:
        f"{OUT}/logs/uniqueness/starts/{{material}}.log",
    params:
        code=UNIQUENESS.follow_code,
        files=lambda wildcards, input, output: [
            *input.table,
            *("--iterations", output.iterations, "-o", output.fit),
        ],
        options=UNIQUENESS.follow_options,


use rule npfm as uniqueness_measure with:
    input:
        fit=rules.uniqueness_starts.output.fit,
        iterations=rules.uniqueness_starts.output.iterations,
        bivariate=lambda wildcards: UNIQUENESS.bivariate(wildcards.material),
    output:
        f"{UNIQUENESS.folder}/{{material}}.csv",
    log:
        f"{OUT}/logs/uniqueness/{{material}}.log",
    wildcard_constraints:
        material=any_of(RUN.materials),
    resources:
        mem_mb=500,
        runtime=5,
    params:
        verb="uniqueness measure",
        code=command_code("uniqueness"),
        files=lambda wildcards, input, output: [
            *(input.fit, "--iterations", input.iterations),
            *("--bivariate", input.bivariate, "-o", *output),
        ],
        options=UNIQUENESS.measure_options,


use rule npfm as uniqueness_table with:
    input:
        expand(rules.uniqueness_measure.output, material=RUN.materials),
    output:
        report(
            f"{OUT}/tables/uniqueness.csv",
            caption="../report/uniqueness.rst",
            category="What factors share",
            labels={"result": "uniqueness"},
        ),
    log:
        f"{OUT}/logs/uniqueness/table.log",
    params:
        verb="uniqueness table",
        code=command_code("uniqueness"),
        files=lambda wildcards, input, output: [*words(input), "-o", *output],


use rule npfm as uniqueness_summary with:
    input:
        rules.uniqueness_table.output,
    output:
        report(
            f"{OUT}/tables/uniqueness_summary.csv",
            caption="../report/uniqueness.rst",
            category="What factors share",
            labels={"result": "uniqueness, all together"},
        ),
    log:
        f"{OUT}/logs/uniqueness/summary.log",
    params:
        verb="uniqueness summary",
        code=command_code("uniqueness"),
        files=lambda wildcards, input, output: [*input, "-o", *output],


use rule npfm as uniqueness_figure with:
    input:
        table=rules.uniqueness_table.output,
        iterations=expand(
            rules.uniqueness_starts.output.iterations, material=RUN.materials
        ),
    output:
        pdf=f"{OUT}/figures/uniqueness.pdf",
        png=report(
            f"{OUT}/figures/uniqueness.png",
            caption="../report/uniqueness_figure.rst",
            category="What factors share",
            labels={"result": "uniqueness, figure"},
        ),
    log:
        f"{OUT}/logs/uniqueness/figure.log",
    params:
        verb="figure uniqueness",
        code=command_code("figure", "npfm.figures.uniqueness"),
        files=lambda wildcards, input, output: [
            *("--table", *input.table),
            *option("--iterations", input.iterations),
            *("-o", *output),
        ],


rule uniqueness:
    input:
        rules.uniqueness_table.output,
        rules.uniqueness_summary.output,
        rules.uniqueness_figure.output,
