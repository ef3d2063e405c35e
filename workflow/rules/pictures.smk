rule render_measured:
    input:
        scene=rules.scene.output,
        table=rules.material.output,
    output:
        f"{OUT}/renders/{{scene}}/{{material}}/measured.exr",
        f"{OUT}/renders/{{scene}}/{{material}}/measured.png",
    params:
        tone=lambda wildcards: RUN.tone(wildcards.scene),
    log:
        f"{OUT}/logs/render/{{scene}}/{{material}}/measured.log",
    resources:
        mem_mb=2000,
    shell:
        "{NPFM} render {input.scene} {input.table} {params.tone} -o {output[0]} 2> >(tee {log} >&2)"


rule render_fit:
    input:
        scene=rules.scene.output,
        fit=rules.fit.output.fit,
        table=rules.material.output,
    output:
        f"{OUT}/renders/{{scene}}/{{material}}/{{variant}}.exr",
        f"{OUT}/renders/{{scene}}/{{material}}/{{variant}}.png",
    params:
        tone=lambda wildcards: RUN.tone(wildcards.scene),
    log:
        f"{OUT}/logs/render/{{scene}}/{{material}}/{{variant}}.log",
    resources:
        mem_mb=2000,
    shell:
        "{NPFM} render {input.scene} {input.fit} --measured {input.table} {params.tone}"
        " -o {output[0]} 2> >(tee {log} >&2)"


ruleorder: render_measured > render_fit
