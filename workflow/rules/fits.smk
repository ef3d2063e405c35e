use rule npfm as fit with:
    input:
        table=rules.material.output,
        published=lambda wildcards: RUN.published_inputs(wildcards.variant),
    output:
        fit=f"{OUT}/fits/{{variant}}/{{material}}.npz",
        record=f"{OUT}/fits/{{variant}}/{{material}}.json",
    log:
        f"{OUT}/logs/fit/{{variant}}/{{material}}.log",
    priority: lambda wildcards: RUN.priority(wildcards, 1)
    group:
        "material"
    resources:
        mem_mb=1000,
        # Nearly all need seconds, and a group adds them up; one that did need more gets it.
        runtime=lambda wildcards, attempt: 15 * 4 ** (attempt - 1),
    params:
        verb="fit",
        code=lambda wildcards: RUN.fit_code(wildcards.variant),
        files=lambda wildcards, input, output: [*input.table, "-o", output.fit],
        options=lambda wildcards: RUN.variants[wildcards.variant].options,
