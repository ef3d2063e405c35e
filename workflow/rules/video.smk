from npfm.exports.gallery.page import templates
from npfm.run.video import plan as plan_video

VIDEO = plan_video(RUN)


use rule fit as video_fit with:
    input:
        table=rules.material.output,
        published=lambda wildcards: VIDEO.study.published_inputs(wildcards.variant),
    output:
        fit=f"{VIDEO.folder}/fits/{{variant}}/{{material}}.npz",
        record=f"{VIDEO.folder}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/video/fits/{{variant}}/{{material}}.log",
    params:
        code=lambda wildcards: VIDEO.study.fit_code(wildcards.variant),
        options=lambda wildcards: VIDEO.study.variants[wildcards.variant].options,


use rule fit as video_starts with:
    input:
        table=rules.material.output,
    output:
        fit=f"{VIDEO.folder}/starts/{{material}}.npz",
        record=f"{VIDEO.folder}/starts/{{material}}.json",
        iterations=f"{VIDEO.folder}/iterations/{{material}}.npz",
    log:
        f"{OUT}/logs/video/starts/{{material}}.log",
    params:
        code=VIDEO.following_code,
        files=lambda wildcards, input, output: [
            *input.table,
            *("--iterations", output.iterations, "-o", output.fit),
        ],
        options=VIDEO.followed.options,


# Half a gigabyte together: they go when all materials have been rendered.
use rule scene as video_scene with:
    input:
        light=RUN.light(VIDEO.scene),
        mesh=RUN.mesh(VIDEO.scene),
    output:
        scene=temp(directory(f"{VIDEO.folder}/scenes/{{turn}}")),
    log:
        f"{OUT}/logs/video/scenes/{{turn}}.log",
    wildcard_constraints:
        turn=any_of(VIDEO.turns),
    params:
        code=VIDEO.scene_code,
        files=lambda wildcards, input, output: [
            *("--light", input.light, "-o", output.scene),
        ],
        options=lambda wildcards: VIDEO.scene_options(wildcards.turn),


use rule npfm as video_frames with:
    input:
        table=rules.material.output,
        scenes=expand(rules.video_scene.output.scene, turn=VIDEO.turns),
        fits=lambda wildcards: [*VIDEO.fits(wildcards.material).values()],
    output:
        f"{VIDEO.folder}/frames/{{material}}.exr",
    log:
        f"{OUT}/logs/video/frames/{{material}}.log",
    resources:
        mem_mb=2000,
        runtime=10,
    params:
        verb="video frames",
        code=command_code("video frames", *VIDEO.modules),
        files=lambda wildcards, input, output: [
            *input.table,
            *option("--scenes", input.scenes),
            *("-o", *output),
        ],
        options=lambda wildcards: option(
            "--fits", map("=".join, VIDEO.fits(wildcards.material).items())
        ),


use rule npfm as video_page with:
    input:
        templates=[as_input(str(path)) for path in templates("video")],
        frames=rules.video_frames.output,
        iterations=rules.video_starts.output.iterations,
    output:
        f"{OUT}/gallery/video/{{material}}.html",
    log:
        f"{OUT}/logs/video/pages/{{material}}.log",
    resources:
        mem_mb=1000,
        runtime=5,
    params:
        verb="video page",
        code=command_code("video page"),
        files=lambda wildcards, input, output: [
            *("--frames", *input.frames, "--iterations", input.iterations),
            *("-o", *output),
        ],
        options=lambda wildcards: [
            *(wildcards.material, "--materials", *VIDEO.materials),
            *RUN.tone_options(VIDEO.scene),
            *RUN.colors_option,
        ],


use rule npfm as video_light with:
    input:
        rules.video_frames.output,
    output:
        f"{OUT}/gallery/video/{{material}}-light.gif",
    log:
        f"{OUT}/logs/video/light/{{material}}.log",
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        verb="video light",
        code=command_code("video light"),
        files=lambda wildcards, input, output: ["--frames", *input, "-o", *output],
        options=lambda wildcards: [
            wildcards.material,
            *RUN.tone_options(VIDEO.scene),
        ],


use rule npfm as video_convergence with:
    input:
        rules.video_starts.output.iterations,
    output:
        f"{OUT}/gallery/video/{{material}}-starts.gif",
    log:
        f"{OUT}/logs/video/convergence/{{material}}.log",
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        verb="video starts",
        code=command_code("video starts"),
        files=lambda wildcards, input, output: ["--iterations", *input, "-o", *output],
        options=lambda wildcards: [wildcards.material],


rule video:
    input:
        expand(rules.video_page.output, material=VIDEO.materials),
        expand(rules.video_light.output, material=VIDEO.materials),
        expand(rules.video_convergence.output, material=VIDEO.materials),
