from npfm.exports.gallery.page import templates


localrules:
    gallery_overview,


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
        code=command_code("gallery"),
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
        code=command_code("gallery"),
        files=lambda wildcards, input, output: [
            *("--quality", *input.quality),
            *("--fits", *input.fits),
            *("--summary", *input.summary),
            *option("--materials", input.materials),
            *("-o", *output),
        ],
        options=[RUN.config["name"], *RUN.colors_option],


rule gallery:
    input:
        rules.gallery_overview.output,
        expand(rules.gallery_material.output, material=RUN.materials),
