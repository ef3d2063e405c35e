from npfm.fitting import registry


localrules:
    stability,


use rule npfm as stability_fits with:
    output:
        f"{OUT}/stability/{{model}}.csv",
    log:
        f"{OUT}/logs/stability/{{model}}.log",
    wildcard_constraints:
        model=any_of(registry.non_parametric()),
    resources:
        mem_mb=1000,
        runtime=120,
    params:
        verb="stability fit",
        code=lambda wildcards: digest(
            (
                f"npfm.models.{wildcards.model.replace('-', '_')}",
                "npfm.fitting.solvers.awls",
                "npfm.fitting.solvers.gauss_newton",
                "npfm.evaluation.stability",
            ),
            ("npfm.commands.stability",),
        ),
        files=lambda wildcards, output: ["-o", *output],
        options=lambda wildcards: [
            wildcards.model,
            *("--starts", f"{RUN.config['stability']['starts']}"),
            *("--awls-iterations", f"{RUN.config['stability']['awls_iterations']}"),
        ],


use rule npfm as stability with:
    input:
        expand(rules.stability_fits.output, model=registry.non_parametric()),
    output:
        f"{OUT}/tables/stability.csv",
    log:
        f"{OUT}/logs/tables/stability.log",
    params:
        verb="stability gather",
        code=digest(("npfm.evaluation.stability",), ("npfm.commands.stability",)),
        files=lambda wildcards, input, output: [*input, "-o", *output],
