# Snakemake formats this path, which may have braces of its own.
ENVIRONMENT = f"{workflow.basedir}/workflow/envs/npfm.yaml".translate(
    {ord("{"): "{{", ord("}"): "}}"}
)


# One command for all rules: its words are quoted here and nowhere else. The rules that use it name
# the verb and give the words: `files` are those that the rule reads and writes, `options` the rest.
# Of the jobs that are ready, scenes come first, which all pictures wait for; then the run's first
# material, so that there is soon something to look at; then what completes one that was begun, so
# that its pictures and its rows are there before the next one's.
# On a cluster a `group` is one submission: a light with its scenes, and all that a material needs
# until its rows are there. Without a cluster Snakemake looks at none of them.
rule npfm:
    log:
        f"{OUT}/logs/npfm.log",
    conda:
        lambda wildcards: ENVIRONMENT
    resources:
        mem_mb=500,
    params:
        verb="--help",
        files=[],
        options=[],
    shell:
        "python -m npfm {params.verb} {params.files:q} {params.options:q} 2> {log:q}"
