from npfm.run.basis import plan as plan_basis

BASIS = plan_basis(RUN)


localrules:
    basis_table,
    basis_figure,
    basis_curves,


use rule fit as basis_fit with:
    input:
        table=rules.material.output,
    output:
        fit=f"{BASIS.folder}/fits/{{variant}}/{{material}}.npz",
        record=f"{BASIS.folder}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/basis/fits/{{variant}}/{{material}}.log",
    params:
        code=lambda wildcards: BASIS.study.fit_code(wildcards.variant),
        options=lambda wildcards: BASIS.study.variants[wildcards.variant].options,


use rule npfm as basis_gather with:
    input:
        lambda wildcards: BASIS.fits(wildcards.variant),
    output:
        f"{BASIS.folder}/{{variant}}.npz",
    log:
        f"{OUT}/logs/basis/{{variant}}.log",
    wildcard_constraints:
        variant=any_of(BASIS.study.variants),
    resources:
        mem_mb=1000,
        runtime=5,
    params:
        verb="basis gather",
        code=command_code("basis"),
        files=lambda wildcards, input, output: [*words(input), "-o", *output],
        options=lambda wildcards: BASIS.gather_options(wildcards.variant),


use rule npfm as basis_measure with:
    input:
        table=rules.material.output,
        factors=rules.basis_gather.output,
        fit=lambda wildcards: BASIS.fit(wildcards.variant, wildcards.material),
        scenes=expand(rules.scene.output.scene, scene=RUN.scenes),
    output:
        f"{BASIS.folder}/{{variant}}/{{material}}.csv",
    log:
        f"{OUT}/logs/basis/{{variant}}/{{material}}.log",
    wildcard_constraints:
        variant=any_of(BASIS.study.variants),
    resources:
        mem_mb=2500,
        runtime=15,
    params:
        verb="basis measure",
        code=lambda wildcards: BASIS.measure_code(wildcards.variant),
        files=lambda wildcards, input, output: [
            *(*input.table, "--factors", *input.factors, "--fit", input.fit),
            *option("--scenes", input.scenes),
            *("-o", *output),
        ],
        options=lambda wildcards: BASIS.measure_options(wildcards.variant),


use rule npfm as basis_table with:
    input:
        expand(
            rules.basis_measure.output,
            variant=BASIS.study.variants,
            material=RUN.materials,
        ),
    output:
        report(
            f"{OUT}/tables/basis.csv",
            caption="../report/basis.rst",
            category="What factors share",
            labels={"result": "curves"},
        ),
    log:
        f"{OUT}/logs/basis/table.log",
    params:
        verb="basis table",
        code=command_code("basis"),
        files=lambda wildcards, input, output: [*words(input), "-o", *output],


use rule npfm as basis_figure with:
    input:
        rules.basis_table.output,
    output:
        pdf=f"{OUT}/figures/basis.pdf",
        png=report(
            f"{OUT}/figures/basis.png",
            caption="../report/basis_figure.rst",
            category="What factors share",
            labels={"result": "how many curves are enough"},
        ),
    log:
        f"{OUT}/logs/basis/figure.log",
    params:
        verb="figure basis",
        code=command_code("figure", "npfm.figures.basis"),
        files=lambda wildcards, input, output: ["--table", *input, "-o", *output],
        options=RUN.colors_option,


use rule npfm as basis_curves with:
    input:
        expand(rules.basis_gather.output, variant=BASIS.study.variants),
    output:
        pdf=f"{OUT}/figures/basis_curves.pdf",
        png=report(
            f"{OUT}/figures/basis_curves.png",
            caption="../report/basis_curves.rst",
            category="What factors share",
            labels={"result": "the curves"},
        ),
    log:
        f"{OUT}/logs/basis/curves.log",
    params:
        verb="figure basis_curves",
        code=command_code("figure", "npfm.figures.basis_curves"),
        files=lambda wildcards, input, output: ["--factors", *input, "-o", *output],


rule basis:
    input:
        rules.basis_table.output,
        rules.basis_figure.output,
        rules.basis_curves.output,
