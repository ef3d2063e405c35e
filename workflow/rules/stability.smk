from npfm.fitting import registry
from npfm.fitting.solvers.choice import SOLVERS, module_of


localrules:
    stability,


use rule npfm as stability_fits with:
    output:
        f"{OUT}/stability/{{model}}.csv",
    log:
        f"{OUT}/logs/stability/{{model}}.log",
    wildcard_constraints:
        model=any_of(registry.fitted()),
    resources:
        mem_mb=1000,
        runtime=120,
    params:
        verb="stability fit",
        code=lambda wildcards: command_code(
            "stability",
            registry.declared(wildcards.model).module,
            *map(module_of, SOLVERS),
        ),
        files=lambda wildcards, output: ["-o", *output],
        options=lambda wildcards: [
            wildcards.model,
            *("--starts", f"{RUN.config['stability']['starts']}"),
            *("--awls-iterations", f"{RUN.config['stability']['awls_iterations']}"),
        ],


use rule npfm as stability with:
    input:
        expand(rules.stability_fits.output, model=registry.fitted()),
    output:
        f"{OUT}/tables/stability.csv",
    log:
        f"{OUT}/logs/tables/stability.log",
    params:
        verb="stability gather",
        code=command_code("stability"),
        files=lambda wildcards, input, output: [*input, "-o", *output],
