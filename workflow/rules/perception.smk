from npfm.run import perception

try:
    OPINIONS = perception.opinion_inputs(RUN)
except NpfmError as error:
    sys.exit(f"npfm: {error}")


localrules:
    perception_pairs,
    perception_correlations,
    perception_figure,


use rule npfm as perception_pairs with:
    input:
        quality=rules.quality_table.output,
        opinions=OPINIONS,
    output:
        f"{OUT}/tables/perception_pairs.csv",
    log:
        f"{OUT}/logs/perception/pairs.log",
    params:
        verb="perception pairs",
        code=command_code("perception"),
        files=lambda wildcards, input, output: [
            *("--quality", *input.quality),
            *("-o", *output),
        ],
        options=option("--opinions", map(path_word, RUN.opinions)),


use rule perception_pairs as perception_correlations with:
    output:
        report(
            f"{OUT}/tables/perception.csv",
            caption="../report/perception.rst",
            category="Perception",
            labels={"result": "table"},
        ),
    log:
        f"{OUT}/logs/perception/correlations.log",
    params:
        verb="perception correlations",


use rule npfm as perception_figure with:
    input:
        rules.perception_correlations.output,
    output:
        pdf=f"{OUT}/figures/perception.pdf",
        png=report(
            f"{OUT}/figures/perception.png",
            caption="../report/perception.rst",
            category="Perception",
            labels={"result": "figure"},
        ),
    log:
        f"{OUT}/logs/perception/figure.log",
    params:
        verb="figure perception",
        code=command_code("figure", "npfm.figures.perception"),
        files=lambda wildcards, input, output: [
            *("--correlations", *input),
            *("-o", *output),
        ],


# Without the opinions there is nothing to compare with.
if OPINIONS:

    rule perception:
        input:
            rules.perception_pairs.output,
            rules.perception_correlations.output,
            rules.perception_figure.output,
