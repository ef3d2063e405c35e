from npfm.run import bounces as bounces_study

BOUNCES = bounces_study.plan(RUN)


localrules:
    bounces_table,
    bounces_figure,


use rule fit as bounces_fit with:
    input:
        table=rules.material.output,
    output:
        fit=f"{BOUNCES.folder}/fits/{{variant}}/{{material}}.npz",
        record=f"{BOUNCES.folder}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/bounces/fits/{{variant}}/{{material}}.log",
    params:
        code=lambda wildcards: BOUNCES.study.fit_code(wildcards.variant),
        options=lambda wildcards: BOUNCES.study.variants[wildcards.variant].options,


use rule npfm as bounces_render with:
    input:
        tables=BOUNCES.tables(),
        fits=lambda wildcards: BOUNCES.fits(wildcards.sampler),
    output:
        exr=f"{BOUNCES.folder}/{{sampler}}.exr",
        record=f"{BOUNCES.folder}/{{sampler}}.json",
    log:
        f"{OUT}/logs/bounces/{{sampler}}.log",
    wildcard_constraints:
        sampler=any_of(BOUNCES.names),
    threads: 2
    resources:
        mem_mb=3000,
        runtime=60,
    params:
        verb="bounces render",
        code=lambda wildcards: command_code(
            "bounces render", *BOUNCES.modules(wildcards.sampler)
        ),
        files=lambda wildcards, output: [
            *BOUNCES.words(wildcards.sampler),
            *("--record", output.record, "-o", output.exr),
        ],
        options=lambda wildcards: BOUNCES.options(wildcards.sampler),


use rule npfm as bounces_table with:
    input:
        expand(rules.bounces_render.output.exr, sampler=BOUNCES.names),
    output:
        report(
            f"{OUT}/tables/bounces.csv",
            caption="../report/bounces.rst",
            category="Light that bounces",
            labels={"result": "table"},
        ),
    log:
        f"{OUT}/logs/bounces/table.log",
    params:
        verb="bounces table",
        code=command_code("bounces table"),
        files=lambda wildcards, input, output: [*input, "-o", *output],


use rule npfm as bounces_figure with:
    input:
        table=rules.bounces_table.output,
        pictures=rules.bounces_table.input,
    output:
        pdf=f"{OUT}/figures/bounces.pdf",
        png=report(
            f"{OUT}/figures/bounces.png",
            caption="../report/bounces.rst",
            category="Light that bounces",
            labels={"result": "figure"},
        ),
    log:
        f"{OUT}/logs/bounces/figure.log",
    params:
        verb="figure bounces",
        code=command_code("figure", "npfm.figures.bounces"),
        files=lambda wildcards, input, output: [
            *("--table", *input.table),
            *("--reference", input.pictures[0]),
            *("--pictures", *input.pictures[1:]),
            *("-o", *output),
        ],


rule bounces:
    input:
        rules.bounces_table.output,
        rules.bounces_figure.output,
