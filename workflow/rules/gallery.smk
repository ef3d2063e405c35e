from npfm.exports.gallery.page import templates
from npfm.exports.registry import declared as declared_format
from npfm.run.video import shown_in_motion


localrules:
    gallery_overview,
    gallery_demo,


use rule npfm as gallery_material with:
    input:
        templates=[as_input(str(path)) for path in templates("material")],
        quality=rules.quality.output,
        # It has pictures and fits for its input, those of the material.
        published=[as_input(path) for path in RUN.published_factors],
    output:
        page=f"{OUT}/gallery/materials/{{material}}.html",
        pictures=f"{OUT}/gallery/materials/{{material}}.jpg",
    log:
        f"{OUT}/logs/gallery/{{material}}.log",
    resources:
        mem_mb=1000,
        runtime=5,
    params:
        verb="gallery material",
        code=command_code("gallery material"),
        files=lambda wildcards, input, output: [
            *("--quality", *input.quality),
            *option("--published", map(path_word, RUN.published_factors)),
            *("-o", output.page),
        ],
        options=lambda wildcards: [
            *(wildcards.material, "--run", OUT),
            *option("--scenes", RUN.tones),
            *option("--variants", RUN.variants_of(wildcards.material)),
            *RUN.colors_option,
            *RUN.demo_option,
            *(["--video"] if wildcards.material in shown_in_motion(RUN) else []),
        ],


use rule npfm as gallery_overview with:
    input:
        templates=[as_input(str(path)) for path in templates("overview")],
        quality=rules.quality_table.output,
        fits=rules.fits_table.output,
        summary=rules.summary_table.output,
        materials=rules.materials_table.output if "naive" in RUN.variants else [],
    output:
        f"{OUT}/gallery/index.html",
    log:
        f"{OUT}/logs/gallery/index.log",
    params:
        verb="gallery overview",
        code=command_code("gallery overview"),
        files=lambda wildcards, input, output: [
            *("--quality", *input.quality),
            *("--fits", *input.fits),
            *("--summary", *input.summary),
            *option("--materials", input.materials),
            *("-o", *output),
        ],
        options=[
            *(RUN.config["name"], *option("--videos", shown_in_motion(RUN))),
            *(*RUN.colors_option, *RUN.demo_option),
        ],


use rule npfm as gallery_demo with:
    input:
        templates=[
            as_input(str(path))
            for path in [*templates("demo"), *declared_format("glsl").files]
        ],
        fits=rules.fits_table.output,
        stored=[
            f"{OUT}/fits/{variant}/{material}.npz" for material, variant in RUN.fits
        ],
        lights=list(dict.fromkeys(map(RUN.light, RUN.scenes))),
    output:
        f"{OUT}/gallery/demo.html",
    log:
        f"{OUT}/logs/gallery/demo.log",
    params:
        verb="gallery demo",
        code=command_code("gallery demo"),
        files=lambda wildcards, input, output: [
            *("--fits", *input.fits),
            *("--lights", *map(RUN.light, RUN.scenes)),
            *("-o", *output),
        ],
        options=[
            *(RUN.config["name"], "--run", OUT),
            *option("--scenes", RUN.tones),
            *option("--measured", RUN.demo_tables),
            *(["--figure"] if RUN.demo_figure else []),
        ],


use rule npfm as gallery_table with:
    input:
        rules.material.output,
    output:
        f"{OUT}/gallery/tables/{{material}}.js",
    log:
        f"{OUT}/logs/gallery/tables/{{material}}.log",
    resources:
        mem_mb=800,
        runtime=5,
    params:
        verb="gallery table",
        code=command_code("gallery table"),
        files=lambda wildcards, input, output: [*input, "-o", *output],


use rule npfm as gallery_figure with:
    input:
        [path for scene in RUN.demo_figure for path in RUN.mesh(scene)],
    output:
        f"{OUT}/gallery/figure.js",
    log:
        f"{OUT}/logs/gallery/figure.log",
    resources:
        mem_mb=800,
        runtime=5,
    params:
        verb="gallery figure",
        code=command_code("gallery figure"),
        files=lambda wildcards, input, output: ["-o", *output],
        options=[word for scene in RUN.demo_figure for word in RUN.mesh_option(scene)],


rule gallery:
    input:
        rules.gallery_overview.output,
        expand(rules.gallery_material.output, material=RUN.materials),
        rules.gallery_demo.output if RUN.has_demo else [],
        rules.gallery_figure.output if RUN.demo_figure else [],
        expand(rules.gallery_table.output, material=RUN.demo_tables),
