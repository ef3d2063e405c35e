rule figure08:
    input:
        psnr=rules.psnr_table.output,
        materials=rules.materials_table.output,
    output:
        f"{OUT}/figures/figure08_by_{{order}}.pdf",
        f"{OUT}/figures/figure08_by_{{order}}.png",
    wildcard_constraints:
        order="diffuseness|error",
    log:
        f"{OUT}/logs/figures/figure08_by_{{order}}.log",
    resources:
        mem_mb=500,
    shell:
        "{NPFM} figure figure08 --psnr {input.psnr} --materials {input.materials}"
        " --order {wildcards.order} -o {output} 2> >(tee {log} >&2)"


rule table1:
    input:
        rules.fits_table.output,
    output:
        f"{OUT}/figures/table1.csv",
    log:
        f"{OUT}/logs/figures/table1.log",
    resources:
        mem_mb=500,
    shell:
        "{NPFM} tables table1 --fits {input} -o {output} 2> >(tee {log} >&2)"


rule figures:
    input:
        expand(rules.figure08.output, order=["diffuseness", "error"]),
        rules.table1.output,
