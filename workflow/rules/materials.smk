rule material:
    input:
        lambda wildcards: RUN.material_inputs(wildcards.material),
    output:
        f"{OUT}/materials/{{material}}.binary",
    log:
        f"{OUT}/logs/material/{{material}}.log",
    # Links and downloads: the nodes of a cluster seldom reach the web.
    localrule: config["dataset"]["kind"] == "merl"
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=800,
        runtime=10,
    params:
        code=RUN.material_code(),
        options=lambda wildcards: RUN.material_options(wildcards.material),
    shell:
        "python -m npfm material {params.options} -o {output} 2> {log}"
