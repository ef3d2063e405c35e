from npfm.run import exports as exports_study

EXPORTS = exports_study.plan(RUN)


use rule fit as exports_fit with:
    input:
        table=rules.material.output,
        published=lambda wildcards: EXPORTS.study.published_inputs(wildcards.variant),
    output:
        fit=f"{EXPORTS.folder}/fits/{{variant}}/{{material}}.npz",
        record=f"{EXPORTS.folder}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/exports/fits/{{variant}}/{{material}}.log",
    params:
        code=lambda wildcards: EXPORTS.study.fit_code(wildcards.variant),
        options=lambda wildcards: EXPORTS.study.variants[wildcards.variant].options,


use rule npfm as export with:
    input:
        source=lambda wildcards: EXPORTS.source(wildcards.variant, wildcards.material),
        parts=lambda wildcards: EXPORTS.parts(wildcards.format),
    output:
        f"{EXPORTS.folder}/{{format}}/{{variant}}/{{material}}{{suffix}}",
    log:
        f"{OUT}/logs/exports/{{format}}/{{variant}}/{{material}}{{suffix}}.log",
    wildcard_constraints:
        format=any_of(EXPORTS.formats(folders=False)),
        suffix=any_of(EXPORTS.suffixes()),
    resources:
        mem_mb=1000,
        runtime=5,
    params:
        verb="export",
        code=lambda wildcards: EXPORTS.code(wildcards.format, wildcards.variant),
        files=lambda wildcards, input, output: [input.source, "-o", *output],
        options=lambda wildcards: EXPORTS.options(wildcards.format),


use rule export as export_folder with:
    output:
        directory(f"{EXPORTS.folder}/{{format}}/{{variant}}/{{material}}"),
    log:
        f"{OUT}/logs/exports/{{format}}/{{variant}}/{{material}}.log",
    wildcard_constraints:
        format=any_of(EXPORTS.formats(folders=True)),


rule exports:
    input:
        list(EXPORTS.written()),
