from npfm.fitting import registry
from npfm.fitting.solvers.choice import SOLVERS, chosen

HARD_CASES = f"{workflow.basedir}/tests/hard_cases.py"
STABILITY = f"{workflow.basedir}/tests/stability.py"


localrules:
    stability,


rule stability_fits:
    input:
        cases=HARD_CASES,
        script=STABILITY,
    output:
        f"{OUT}/stability/{{model}}.csv",
    log:
        f"{OUT}/logs/stability/{{model}}.log",
    wildcard_constraints:
        model="|".join(registry.non_parametric()),
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=1000,
        runtime=120,
    params:
        code=lambda wildcards: digest(
            (
                f"npfm.models.{wildcards.model.replace('-', '_')}",
                "npfm.fitting.solvers.awls",
                "npfm.fitting.solvers.gauss_newton",
            )
        ),
        starts=config["stability"]["starts"],
        awls_iterations=config["stability"]["awls_iterations"],
    shell:
        "python {input.script} fit {wildcards.model} --starts {params.starts}"
        " --awls-iterations {params.awls_iterations} -o {output} 2> {log}"


rule stability:
    input:
        tables=expand(rules.stability_fits.output, model=registry.non_parametric()),
        cases=HARD_CASES,
        script=STABILITY,
    output:
        f"{OUT}/tables/stability.csv",
    log:
        f"{OUT}/logs/tables/stability.log",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    shell:
        "python {input.script} gather {input.tables} -o {output} 2> {log}"
