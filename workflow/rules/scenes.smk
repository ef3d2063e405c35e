rule light:
    input:
        lambda wildcards: RUN.light_inputs(wildcards.light),
    output:
        f"{OUT}/lights/{{light}}.exr",
    params:
        options=lambda wildcards: RUN.light_options(wildcards.light),
    log:
        f"{OUT}/logs/light/{{light}}.log",
    resources:
        mem_mb=1000,
    shell:
        "{NPFM} light {params.options} -o {output} 2> >(tee {log} >&2)"


rule scene:
    input:
        light=lambda wildcards: f"{OUT}/lights/{config['scenes'][wildcards.scene]['light']}.exr",
        mesh=lambda wildcards: RUN.mesh(wildcards.scene),
    output:
        directory(f"{OUT}/scenes/{{scene}}"),
    params:
        options=lambda wildcards: RUN.scene_options(wildcards.scene),
    log:
        f"{OUT}/logs/scene/{{scene}}.log",
    resources:
        mem_mb=3000,
    shell:
        "{NPFM} scene --light {input.light} {params.options} -o {output} 2> >(tee {log} >&2)"
