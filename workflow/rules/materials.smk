rule material:
    input:
        lambda wildcards: RUN.material_inputs(wildcards.material),
    output:
        f"{OUT}/materials/{{material}}.binary",
    params:
        options=lambda wildcards: RUN.material_options(wildcards.material),
    log:
        f"{OUT}/logs/material/{{material}}.log",
    resources:
        mem_mb=800,
    shell:
        "{NPFM} material {params.options} -o {output} 2> >(tee {log} >&2)"
