rule render_measured:
    input:
        scene=rules.scene.output.scene,
        table=rules.material.output,
    output:
        exr=f"{OUT}/renders/{{scene}}/{{material}}/measured.exr",
        png=f"{OUT}/renders/{{scene}}/{{material}}/measured.png",
    log:
        f"{OUT}/logs/render/{{scene}}/{{material}}/measured.log",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=2000,
        runtime=5,
    params:
        code=RUN.render_code("measured"),
        tone=lambda wildcards: RUN.tone(wildcards.scene),
    shell:
        "python -m npfm render {input.scene} {input.table} {params.tone} -o {output.exr} 2> {log}"


rule render_fit:
    input:
        scene=rules.scene.output.scene,
        fit=rules.fit.output.fit,
        table=rules.material.output,
    output:
        exr=f"{OUT}/renders/{{scene}}/{{material}}/{{variant}}.exr",
        png=f"{OUT}/renders/{{scene}}/{{material}}/{{variant}}.png",
    log:
        f"{OUT}/logs/render/{{scene}}/{{material}}/{{variant}}.log",
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=2000,
        runtime=5,
    params:
        code=lambda wildcards: RUN.render_code(wildcards.variant),
        tone=lambda wildcards: RUN.tone(wildcards.scene),
    shell:
        "python -m npfm render {input.scene} {input.fit} --measured {input.table} {params.tone}"
        " -o {output.exr} 2> {log}"


ruleorder: render_measured > render_fit
