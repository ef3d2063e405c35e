RENDERS = expand(
    f"{OUT}/renders/{{scene}}/{{material}}/{{variant}}.exr",
    scene=RUN.scenes,
    material=RUN.materials,
    variant=["measured", *RUN.variants],
)
MATERIALS = f"--run {OUT} --materials {' '.join(RUN.materials)}"
VARIANTS = f"--variants {' '.join(RUN.variants)}"


rule psnr_table:
    input:
        RENDERS,
    output:
        f"{OUT}/tables/psnr.csv",
    params:
        names=f"{MATERIALS} {VARIANTS} --scenes {' '.join(RUN.scenes)}",
    log:
        f"{OUT}/logs/tables/psnr.log",
    resources:
        mem_mb=500,
    shell:
        "{NPFM} tables psnr {params.names} -o {output} 2> >(tee {log} >&2)"


rule fits_table:
    input:
        expand(rules.fit.output.record, material=RUN.materials, variant=RUN.variants),
    output:
        f"{OUT}/tables/fits.csv",
    params:
        names=f"{MATERIALS} {VARIANTS}",
    log:
        f"{OUT}/logs/tables/fits.log",
    resources:
        mem_mb=500,
    shell:
        "{NPFM} tables fits {params.names} -o {output} 2> >(tee {log} >&2)"


rule materials_table:
    input:
        expand(rules.fit.output.fit, material=RUN.materials, variant="naive"),
    output:
        f"{OUT}/tables/materials.csv",
    params:
        names=MATERIALS,
    log:
        f"{OUT}/logs/tables/materials.log",
    resources:
        mem_mb=500,
    shell:
        "{NPFM} tables materials {params.names} -o {output} 2> >(tee {log} >&2)"


rule summary_table:
    input:
        psnr=rules.psnr_table.output,
        records=rules.fits_table.input,
    output:
        f"{OUT}/tables/summary.csv",
    params:
        names=f"{MATERIALS} {VARIANTS}",
    log:
        f"{OUT}/logs/tables/summary.log",
    resources:
        mem_mb=500,
    shell:
        "{NPFM} tables summary --psnr {input.psnr} {params.names} -o {output} 2> >(tee {log} >&2)"


rule tables:
    input:
        rules.psnr_table.output,
        rules.fits_table.output,
        rules.materials_table.output,
        rules.summary_table.output,
