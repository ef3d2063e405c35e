rule fit:
    input:
        rules.material.output,
    output:
        fit=f"{OUT}/fits/{{variant}}/{{material}}.npz",
        record=f"{OUT}/fits/{{variant}}/{{material}}.json",
    params:
        options=lambda wildcards: RUN.variants[wildcards.variant].options,
    log:
        f"{OUT}/logs/fit/{{variant}}/{{material}}.log",
    resources:
        mem_mb=1000,
    shell:
        "{NPFM} fit {input} {params.options} -o {output.fit} 2> >(tee {log} >&2)"
