RENDERS = [
    f"{OUT}/renders/{scene}/{material}/{variant}.exr"
    for scene in RUN.scenes
    for material in RUN.materials
    for variant in ["measured", *RUN.variants_of(material)]
]
TABLES_CODE = digest(("npfm.evaluation.tables",), ("npfm.commands.tables",))
MATERIALS = f"--run {OUT} --materials {' '.join(RUN.materials)}"
VARIANTS = f"--variants {' '.join(RUN.variants)} {RUN.missing_option}"


localrules:
    psnr_table,
    fits_table,
    materials_table,
    summary_table,


rule psnr_table:
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
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=TABLES_CODE,
        names=f"{MATERIALS} {VARIANTS} --scenes {' '.join(RUN.scenes)}",
    shell:
        "python -m npfm tables psnr {params.names} -o {output} 2> {log}"


rule fits_table:
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
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=TABLES_CODE,
        names=f"{MATERIALS} {VARIANTS}",
    shell:
        "python -m npfm tables fits {params.names} -o {output} 2> {log}"


rule materials_table:
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
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=TABLES_CODE,
        names=MATERIALS,
    shell:
        "python -m npfm tables materials {params.names} -o {output} 2> {log}"


rule summary_table:
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
    conda:
        "../envs/npfm.yaml"
    resources:
        mem_mb=500,
    params:
        code=TABLES_CODE,
        run=f"--run {OUT}",
    shell:
        "python -m npfm tables summary {params.run} --psnr {input.psnr} -o {output} 2> {log}"


rule tables:
    input:
        rules.psnr_table.output,
        rules.fits_table.output,
        rules.summary_table.output,
        rules.materials_table.output if "naive" in RUN.variants else [],
