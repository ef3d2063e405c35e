use rule npfm as light with:
    input:
        lambda wildcards: RUN.light_inputs(wildcards.light),
    output:
        f"{OUT}/lights/{{light}}.exr",
    log:
        f"{OUT}/logs/light/{{light}}.log",
    priority: 8
    group:
        "scene"
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        verb="light",
        code=lambda wildcards: RUN.light_code(wildcards.light),
        files=lambda wildcards, output: ["-o", *output],
        options=lambda wildcards: RUN.light_options(wildcards.light),


use rule npfm as scene with:
    input:
        light=lambda wildcards: RUN.light(wildcards.scene),
        mesh=lambda wildcards: RUN.mesh(wildcards.scene),
    output:
        scene=directory(f"{OUT}/scenes/{{scene}}"),
        record=f"{OUT}/scenes/{{scene}}.json",
    log:
        f"{OUT}/logs/scene/{{scene}}.log",
    wildcard_constraints:
        scene=any_of(RUN.scenes),
    priority: 8
    group:
        "scene"
    resources:
        mem_mb=3000,
        runtime=20,
    params:
        verb="scene",
        code=lambda wildcards: RUN.scene_code(wildcards.scene),
        files=lambda wildcards, input, output: [
            *("--light", input.light),
            *("--record", output.record, "-o", output.scene),
        ],
        options=lambda wildcards: RUN.scene_options(wildcards.scene),
