# In one order, so that another one in the configuration renders nothing again.
SCENES = sorted(RUN.scenes)


# Of scenes that list interreflection, and what the target effects switches; by Mitsuba.
use rule npfm as bounced_measured with:
    input:
        table=rules.material.output,
        light=lambda wildcards: RUN.light(wildcards.scene),
        mesh=lambda wildcards: RUN.mesh(wildcards.scene),
    output:
        exr=f"{OUT}/bounced/{{scene}}/{{material}}/measured.exr",
        record=f"{OUT}/bounced/{{scene}}/{{material}}/measured.json",
    log:
        f"{OUT}/logs/bounced/{{scene}}/{{material}}/measured.log",
    priority: lambda wildcards: RUN.priority(wildcards, 2)
    group:
        "material"
    threads: 2
    resources:
        mem_mb=2500,
        runtime=60,
    params:
        verb="interreflect",
        code=RUN.bounced_code(),
        files=lambda wildcards, input, output: [
            *input.table,
            *("--light", input.light),
            *("--record", output.record, "-o", output.exr),
        ],
        options=lambda wildcards: RUN.bounced_options(wildcards.scene),


use rule bounced_measured as bounced_fit with:
    input:
        fit=rules.fit.output.fit,
        table=rules.material.output,
        light=lambda wildcards: RUN.light(wildcards.scene),
        mesh=lambda wildcards: RUN.mesh(wildcards.scene),
    output:
        exr=f"{OUT}/bounced/{{scene}}/{{material}}/{{variant}}.exr",
        record=f"{OUT}/bounced/{{scene}}/{{material}}/{{variant}}.json",
    log:
        f"{OUT}/logs/bounced/{{scene}}/{{material}}/{{variant}}.log",
    params:
        code=lambda wildcards: RUN.bounced_code(wildcards.variant),
        files=lambda wildcards, input, output: [
            input.fit,
            *("--measured", *input.table, "--light", input.light),
            *("--record", output.record, "-o", output.exr),
        ],


ruleorder: bounced_measured > bounced_fit


# One job renders in all scenes: Python starts once, and the table is read or made once.
use rule npfm as render_measured with:
    input:
        scenes=expand(rules.scene.output.scene, scene=SCENES),
        table=rules.material.output,
        bounced=lambda wildcards: RUN.bounced(wildcards),
    output:
        exr=expand(
            f"{OUT}/renders/{{scene}}/{{{{material}}}}/measured.exr", scene=SCENES
        ),
        png=expand(
            f"{OUT}/renders/{{scene}}/{{{{material}}}}/measured.png", scene=SCENES
        ),
    log:
        f"{OUT}/logs/render/{{material}}/measured.log",
    priority: lambda wildcards: RUN.priority(wildcards, 3)
    group:
        "material"
    resources:
        mem_mb=2000,
        runtime=10,
    params:
        verb="render",
        code=RUN.render_code("measured"),
        files=lambda wildcards, input, output: [
            *words([*input.scenes, *input.table]),
            *RUN.bounced_option(input.get("bounced", [])),
            *option("-o", output.exr),
        ],
        options=RUN.tone_options(*SCENES),


use rule render_measured as render_fit with:
    input:
        scenes=expand(rules.scene.output.scene, scene=SCENES),
        fit=rules.fit.output.fit,
        table=rules.material.output,
        bounced=lambda wildcards: RUN.bounced(wildcards),
    output:
        exr=expand(
            f"{OUT}/renders/{{scene}}/{{{{material}}}}/{{{{variant}}}}.exr",
            scene=SCENES,
        ),
        png=expand(
            f"{OUT}/renders/{{scene}}/{{{{material}}}}/{{{{variant}}}}.png",
            scene=SCENES,
        ),
    log:
        f"{OUT}/logs/render/{{material}}/{{variant}}.log",
    params:
        code=lambda wildcards: RUN.render_code(wildcards.variant),
        files=lambda wildcards, input, output: [
            *words([*input.scenes, input.fit]),
            *("--measured", *input.table),
            *RUN.bounced_option(input.get("bounced", [])),
            *option("-o", output.exr),
        ],


ruleorder: render_measured > render_fit
