from npfm.run.blends import plan as plan_blends

BLENDS = plan_blends(RUN)


localrules:
    blends_figure,


use rule fit as blends_fit with:
    input:
        table=rules.material.output,
    output:
        fit=f"{BLENDS.folder}/fits/{{variant}}/{{material}}.npz",
        record=f"{BLENDS.folder}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/blends/fits/{{variant}}/{{material}}.log",
    params:
        code=lambda wildcards: BLENDS.study.fit_code(wildcards.variant),
        options=lambda wildcards: BLENDS.study.variants[wildcards.variant].options,


use rule npfm as blends_gather with:
    input:
        BLENDS.gather_inputs,
    output:
        f"{BLENDS.folder}/factors.npz",
    log:
        f"{OUT}/logs/blends/gather.log",
    resources:
        mem_mb=1000,
        runtime=5,
    params:
        verb="basis gather",
        code=command_code("basis"),
        files=lambda wildcards, input, output: [*words(input), "-o", *output],
        options=BLENDS.gather_options,


use rule npfm as blends_measure with:
    input:
        scene=f"{OUT}/scenes/{BLENDS.scene}",
        tables=BLENDS.tables,
        fits=BLENDS.fits,
        factors=rules.blends_gather.output,
        weights=BLENDS.weights,
        mesh=RUN.mesh(BLENDS.scene),
    output:
        table=report(
            f"{OUT}/tables/blends.csv",
            caption="../report/blends.rst",
            category="Materials that vary",
            labels={"result": "cost"},
        ),
        half_way=report(
            f"{OUT}/tables/blends_half_way.csv",
            caption="../report/blends.rst",
            category="Materials that vary",
            labels={"result": "half way"},
        ),
        pictures=f"{BLENDS.folder}/pictures.exr",
    log:
        f"{OUT}/logs/blends/measure.log",
    resources:
        mem_mb=4000,
        runtime=30,
    params:
        verb="blends",
        code=command_code("blends", *BLENDS.study.model_modules(BLENDS.variant)),
        files=lambda wildcards, input, output: [
            input.scene,
            *BLENDS.word_options,
            *("--factors", *input.factors),
            *("--pictures", output.pictures, "--half-way", output.half_way),
            *("-o", output.table),
        ],
        options=BLENDS.blends_options,


use rule npfm as blends_figure with:
    input:
        table=rules.blends_measure.output.table,
        half_way=rules.blends_measure.output.half_way,
        pictures=rules.blends_measure.output.pictures,
    output:
        pdf=f"{OUT}/figures/blends.pdf",
        png=report(
            f"{OUT}/figures/blends.png",
            caption="../report/blends.rst",
            category="Materials that vary",
            labels={"result": "figure"},
        ),
    log:
        f"{OUT}/logs/blends/figure.log",
    params:
        verb="figure blends",
        code=command_code("figure", "npfm.figures.blends"),
        files=lambda wildcards, input, output: [
            *("--table", input.table, "--half-way", input.half_way),
            *("--pictures", input.pictures, "-o", *output),
        ],
        options=RUN.tone_options(BLENDS.scene),


rule blends:
    input:
        rules.blends_measure.output,
        rules.blends_figure.output,
