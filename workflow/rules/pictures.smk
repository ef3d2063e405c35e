use rule npfm as render_measured with:
    input:
        scene=rules.scene.output.scene,
        table=rules.material.output,
    output:
        exr=f"{OUT}/renders/{{scene}}/{{material}}/measured.exr",
        png=f"{OUT}/renders/{{scene}}/{{material}}/measured.png",
    log:
        f"{OUT}/logs/render/{{scene}}/{{material}}/measured.log",
    resources:
        mem_mb=2000,
        runtime=5,
    params:
        verb="render",
        code=RUN.render_code("measured"),
        files=lambda wildcards, input, output: [
            *(input.scene, *input.table),
            *("-o", output.exr),
        ],
        options=lambda wildcards: RUN.tone_options(wildcards.scene),


use rule render_measured as render_fit with:
    input:
        scene=rules.scene.output.scene,
        fit=rules.fit.output.fit,
        table=rules.material.output,
    output:
        exr=f"{OUT}/renders/{{scene}}/{{material}}/{{variant}}.exr",
        png=f"{OUT}/renders/{{scene}}/{{material}}/{{variant}}.png",
    log:
        f"{OUT}/logs/render/{{scene}}/{{material}}/{{variant}}.log",
    params:
        code=lambda wildcards: RUN.render_code(wildcards.variant),
        files=lambda wildcards, input, output: [
            *(input.scene, input.fit),
            *("--measured", *input.table),
            *("-o", output.exr),
        ],


ruleorder: render_measured > render_fit
