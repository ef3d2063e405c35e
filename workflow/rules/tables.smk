RENDERS = [
    f"{OUT}/renders/{scene}/{material}/{variant}.exr"
    for scene in RUN.scenes
    for material in RUN.materials
    for variant in ["measured", *RUN.variants_of(material)]
]
TABLES_CODE = command_code("tables")
MATERIALS = ["--run", OUT, *option("--materials", RUN.materials)]
VARIANTS = [*option("--variants", RUN.variants), *RUN.missing_option]


localrules:
    psnr_table,
    fits_table,
    materials_table,
    summary_table,


use rule npfm as psnr_table with:
    input:
        RENDERS,
    output:
        report(
            f"{OUT}/tables/psnr.csv",
            caption="../report/psnr.rst",
            category="Tables",
            labels={"table": "PSNR of all renderings"},
        ),
    log:
        f"{OUT}/logs/tables/psnr.log",
    params:
        verb="tables psnr",
        code=TABLES_CODE,
        files=lambda wildcards, output: ["-o", *output],
        options=[*MATERIALS, *VARIANTS, *option("--scenes", RUN.scenes)],


use rule psnr_table as fits_table with:
    input:
        [f"{OUT}/fits/{variant}/{material}.json" for material, variant in RUN.fits],
    output:
        report(
            f"{OUT}/tables/fits.csv",
            caption="../report/fits.rst",
            category="Tables",
            labels={"table": "fits of all channels"},
        ),
    log:
        f"{OUT}/logs/tables/fits.log",
    params:
        verb="tables fits",
        options=[*MATERIALS, *VARIANTS],


use rule psnr_table as materials_table with:
    input:
        expand(rules.fit.output.fit, material=RUN.materials, variant="naive"),
    output:
        report(
            f"{OUT}/tables/materials.csv",
            caption="../report/materials.rst",
            category="Tables",
            labels={"table": "diffuseness"},
        ),
    log:
        f"{OUT}/logs/tables/materials.log",
    params:
        verb="tables materials",
        options=MATERIALS,


use rule psnr_table as summary_table with:
    input:
        psnr=rules.psnr_table.output,
        records=rules.fits_table.input,
    output:
        report(
            f"{OUT}/tables/summary.csv",
            caption="../report/summary.rst",
            category="Tables",
            labels={"table": "mean PSNR and size"},
        ),
    log:
        f"{OUT}/logs/tables/summary.log",
    params:
        verb="tables summary",
        files=lambda wildcards, input, output: ["--psnr", *input.psnr, "-o", *output],
        options=["--run", OUT],


rule tables:
    input:
        rules.psnr_table.output,
        rules.fits_table.output,
        rules.summary_table.output,
        rules.materials_table.output if "naive" in RUN.variants else [],
