localrules:
    quality_table,
    quality_summary,


use rule npfm as quality with:
    input:
        table=rules.material.output,
        fits=lambda wildcards: expand(
            f"{OUT}/fits/{{variant}}/{wildcards.material}.npz",
            variant=RUN.variants_of(wildcards.material),
        ),
        pictures=lambda wildcards: expand(
            f"{OUT}/renders/{{scene}}/{wildcards.material}/{{variant}}.{{end}}",
            scene=RUN.scenes,
            variant=["measured", *RUN.variants_of(wildcards.material)],
            end=["exr", "png"],
        ),
    output:
        f"{OUT}/quality/{{material}}.csv",
    log:
        f"{OUT}/logs/quality/{{material}}.log",
    priority: lambda wildcards: RUN.priority(wildcards, 3)
    group:
        "material"
    resources:
        mem_mb=1000,
        runtime=15,
    params:
        verb="quality material",
        code=command_code("quality material", *RUN.model_modules(*RUN.variants)),
        files=lambda wildcards, input, output: [*input.table, "-o", *output],
        options=lambda wildcards: [
            *("--run", OUT),
            *option("--scenes", RUN.scenes),
            *option("--variants", RUN.variants_of(wildcards.material)),
        ],


use rule npfm as quality_table with:
    input:
        expand(rules.quality.output, material=RUN.materials),
    output:
        report(
            f"{OUT}/tables/quality.csv",
            caption="../report/quality.rst",
            category="Tables",
            labels={"table": "every metric of every picture and table"},
        ),
    log:
        f"{OUT}/logs/tables/quality.log",
    params:
        verb="quality gather",
        code=command_code("quality gather"),
        files=lambda wildcards, input, output: [*words(input), "-o", *output],


use rule npfm as quality_summary with:
    input:
        rules.quality_table.output,
    output:
        report(
            f"{OUT}/tables/quality_summary.csv",
            caption="../report/quality.rst",
            category="Tables",
            labels={"table": "mean and median of every metric"},
        ),
    log:
        f"{OUT}/logs/tables/quality_summary.log",
    params:
        verb="quality summary",
        code=command_code("quality summary"),
        files=lambda wildcards, input, output: [*input, "-o", *output],
