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
        directory(f"{OUT}/scenes/{{scene}}"),
    log:
        f"{OUT}/logs/scene/{{scene}}.log",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=3000,
        runtime=20,
    params:
        code=digest(("npfm.assembly", "npfm.transport"), ("npfm.commands.scene",)),
        options=lambda wildcards: RUN.scene_options(wildcards.scene),
    shell:
        "python -m npfm scene --light {input.light} {params.options} -o {output} 2> {log}"
