from npfm.fitting import registry


localrules:
    stability,


rule stability_fits:
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
                "npfm.evaluation.stability",
            ),
            ("npfm.commands.stability",),
        ),
        starts=config["stability"]["starts"],
        awls_iterations=config["stability"]["awls_iterations"],
    shell:
        "python -m npfm stability fit {wildcards.model} --starts {params.starts}"
        " --awls-iterations {params.awls_iterations} -o {output} 2> {log}"


rule stability:
    input:
        expand(rules.stability_fits.output, model=registry.non_parametric()),
    output:
        f"{OUT}/tables/stability.csv",
    log:
        f"{OUT}/logs/tables/stability.log",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=digest(("npfm.evaluation.stability",), ("npfm.commands.stability",)),
    shell:
        "python -m npfm stability gather {input} -o {output} 2> {log}"
