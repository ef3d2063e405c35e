# Links and downloads: the nodes of a cluster seldom reach the web.
LINKED = RUN.config["dataset"]["kind"] in ("merl", "utia")
if LINKED:

    localrules:
        material,


use rule npfm as material with:
    input:
        lambda wildcards: RUN.material_inputs(wildcards.material),
    output:
        RUN.table("{material}"),
    log:
        f"{OUT}/logs/material/{{material}}.log",
    priority: lambda wildcards: RUN.priority(wildcards, 0)
    # What is in a group runs on nodes.
    group:
        None if LINKED else "material"
    resources:
        mem_mb=800,
        runtime=10,
    params:
        verb="material",
        code=RUN.material_code(),
        files=lambda wildcards, output: ["-o", *output],
        options=lambda wildcards: RUN.material_options(wildcards.material),
