rule fit:
    input:
        table=rules.material.output,
        published=lambda wildcards: RUN.published_inputs(wildcards.variant),
    output:
        fit=f"{OUT}/fits/{{variant}}/{{material}}.npz",
        record=f"{OUT}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/fit/{{variant}}/{{material}}.log",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=1000,
        runtime=60,
    params:
        code=lambda wildcards: RUN.fit_code(wildcards.variant),
        options=lambda wildcards: RUN.variants[wildcards.variant].options,
    shell:
        "python -m npfm fit {input.table} {params.options} -o {output.fit} 2> {log}"
