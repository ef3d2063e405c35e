import re


rule light:
    input:
        lambda wildcards: RUN.light_inputs(wildcards.light),
    output:
        f"{OUT}/lights/{{light}}.exr",
    log:
        f"{OUT}/logs/light/{{light}}.log",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        code=lambda wildcards: RUN.light_code(wildcards.light),
        options=lambda wildcards: RUN.light_options(wildcards.light),
    shell:
        "python -m npfm light {params.options} -o {output} 2> {log}"


rule scene:
    input:
        light=lambda wildcards: f"{OUT}/lights/{config['scenes'][wildcards.scene]['light']}.exr",
        mesh=lambda wildcards: RUN.mesh(wildcards.scene),
    output:
        scene=directory(f"{OUT}/scenes/{{scene}}"),
        record=f"{OUT}/scenes/{{scene}}.json",
    log:
        f"{OUT}/logs/scene/{{scene}}.log",
    wildcard_constraints:
        scene="|".join(map(re.escape, RUN.scenes)),
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=3000,
        runtime=20,
    params:
        code=lambda wildcards: RUN.scene_code(wildcards.scene),
        options=lambda wildcards: RUN.scene_options(wildcards.scene),
    shell:
        "python -m npfm scene --light {input.light} {params.options}"
        " --record {output.record} -o {output.scene} 2> {log}"
