from npfm.run.psnr_level import plan as plan_psnr_level

LEVEL = plan_psnr_level(RUN)


localrules:
    psnr_level_table,
    psnr_level_figure,


use rule scene as psnr_level_scene with:
    output:
        scene=directory(f"{LEVEL.folder}/scenes/{{scene}}/{{way}}"),
        record=f"{LEVEL.folder}/scenes/{{scene}}/{{way}}.json",
    log:
        f"{OUT}/logs/psnr_level/scenes/{{scene}}/{{way}}.log",
    wildcard_constraints:
        way=any_of(LEVEL.built),
    resources:
        mem_mb=6000,
        runtime=60,
    params:
        options=lambda wildcards: LEVEL.scene_options(wildcards.scene, wildcards.way),


use rule npfm as psnr_level_angles with:
    input:
        mesh=lambda wildcards: RUN.mesh(wildcards.scene),
    output:
        f"{LEVEL.folder}/angles/{{scene}}.exr",
    log:
        f"{OUT}/logs/psnr_level/angles/{{scene}}.log",
    wildcard_constraints:
        scene=any_of(RUN.scenes),
    resources:
        mem_mb=1000,
        runtime=5,
    params:
        verb="psnr-level angles",
        code=command_code("psnr-level angles"),
        files=lambda wildcards, output: ["-o", *output],
        options=lambda wildcards: LEVEL.angles_options(wildcards.scene),


use rule npfm as psnr_level_measure with:
    input:
        table=rules.material.output,
        fits=lambda wildcards: LEVEL.fits(wildcards.material).values(),
        scenes=LEVEL.scenes,
        angles=expand(rules.psnr_level_angles.output, scene=RUN.scenes),
    output:
        f"{LEVEL.folder}/{{material}}.csv",
    log:
        f"{OUT}/logs/psnr_level/{{material}}.log",
    wildcard_constraints:
        material=any_of(LEVEL.materials),
    resources:
        mem_mb=4000,
        runtime=15,
    params:
        verb="psnr-level measure",
        code=command_code("psnr-level measure", *RUN.model_modules(*LEVEL.variants)),
        files=lambda wildcards, input, output: [*input.table, "-o", *output],
        options=lambda wildcards: LEVEL.measure_options(wildcards.material),


use rule npfm as psnr_level_table with:
    input:
        expand(rules.psnr_level_measure.output, material=LEVEL.materials),
    output:
        report(
            f"{OUT}/tables/psnr_level.csv",
            caption="../report/psnr_level.rst",
            category="The level of PSNR",
            labels={"result": "table"},
        ),
    log:
        f"{OUT}/logs/psnr_level/table.log",
    params:
        verb="psnr-level table",
        code=command_code("psnr-level table"),
        files=lambda wildcards, input, output: [*words(input), "-o", *output],


use rule npfm as psnr_level_figure with:
    input:
        rules.psnr_level_table.output,
    output:
        pdf=f"{OUT}/figures/psnr_level.pdf",
        png=report(
            f"{OUT}/figures/psnr_level.png",
            caption="../report/psnr_level_figure.rst",
            category="The level of PSNR",
            labels={"result": "figure"},
        ),
    log:
        f"{OUT}/logs/psnr_level/figure.log",
    params:
        verb="figure psnr_level",
        code=command_code("figure", "npfm.figures.psnr_level"),
        files=lambda wildcards, input, output: ["--levels", *input, "-o", *output],
        options=RUN.colors_option,


rule psnr_level:
    input:
        rules.psnr_level_table.output,
        rules.psnr_level_figure.output,
