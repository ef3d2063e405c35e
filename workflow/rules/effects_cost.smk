from npfm.run.effects_cost import Plan as EffectsPlan

EFFECTS = EffectsPlan(RUN)
EFFECTS_CODE = command_code("effects-cost", *COST.standard_modules)


localrules:
    effects_table,
    effects_figure,


use rule scene as effects_scene with:
    output:
        scene=directory(f"{EFFECTS.folder}/scenes/{{scene}}/{{effect}}"),
        record=f"{EFFECTS.folder}/scenes/{{scene}}/{{effect}}.json",
    log:
        f"{OUT}/logs/effects/scenes/{{scene}}/{{effect}}.log",
    wildcard_constraints:
        effect=any_of(EFFECTS.all_effects),
    params:
        options=lambda wildcards: EFFECTS.scene_options(
            wildcards.scene, wildcards.effect
        ),


use rule bounced_fit as effects_bounced_fit with:
    input:
        fit=f"{COST.standard}/{{material}}.npz",
        table=rules.material.output,
        light=lambda wildcards: RUN.light(wildcards.scene),
        mesh=lambda wildcards: RUN.mesh(wildcards.scene),
    output:
        exr=f"{EFFECTS.folder}/bounced/{{scene}}/{{material}}.exr",
        record=f"{EFFECTS.folder}/bounced/{{scene}}/{{material}}.json",
    log:
        f"{OUT}/logs/effects/bounced/{{scene}}/{{material}}.log",
    params:
        code=command_code("interreflect", *COST.standard_modules),


use rule npfm as effects_compare with:
    input:
        scene=rules.scene.output.scene,
        record=rules.scene.output.record,
        switched=lambda wildcards: EFFECTS.builds(wildcards.scene),
        records=lambda wildcards: [
            f"{build}.json" for build in EFFECTS.builds(wildcards.scene)
        ],
        tables=expand(rules.material.output, material=COST.materials),
        fits=expand(
            "{folder}/{material}.npz", folder=COST.standard, material=COST.materials
        ),
        bounced_tables=lambda wildcards: EFFECTS.bounced(
            wildcards.scene, COST.materials
        )[0],
        bounced_fits=lambda wildcards: EFFECTS.bounced(
            wildcards.scene, COST.materials
        )[1],
    output:
        table=f"{EFFECTS.folder}/{{scene}}.csv",
        pictures=f"{EFFECTS.folder}/{{scene}}.exr",
    log:
        f"{OUT}/logs/effects/{{scene}}.log",
    resources:
        mem_mb=2500,
        runtime=15,
    params:
        verb="effects-cost compare",
        code=EFFECTS_CODE,
        files=lambda wildcards, input, output: [
            input.scene,
            *option("--tables", input.tables),
            *option("--fits", input.fits),
            *option("--bounced-tables", input.bounced_tables),
            *option("--bounced-fits", input.bounced_fits),
            *("-o", output.table, "--pictures", output.pictures),
        ],
        options=lambda wildcards: [
            *option("--switched", EFFECTS.switched(wildcards.scene)),
            *EFFECTS.bounced_options(wildcards.scene),
        ],


use rule npfm as effects_table with:
    input:
        expand(rules.effects_compare.output.table, scene=RUN.scenes),
    output:
        report(
            f"{OUT}/tables/effects.csv",
            caption="../report/effects.rst",
            category="Cost of effects",
            labels={"result": "table"},
        ),
    log:
        f"{OUT}/logs/effects/table.log",
    params:
        verb="effects-cost table",
        code=EFFECTS_CODE,
        files=lambda wildcards, input, output: [*input, "-o", *output],


use rule npfm as effects_figure with:
    input:
        table=rules.effects_table.output,
        changed=expand(rules.effects_compare.output.pictures, scene=RUN.scenes),
        shown=expand(
            f"{OUT}/renders/{{scene}}/{{material}}/measured.png",
            scene=RUN.scenes,
            material=COST.materials[-1],
        ),
    output:
        pdf=f"{OUT}/figures/effects.pdf",
        png=report(
            f"{OUT}/figures/effects.png",
            caption="../report/effects_figure.rst",
            category="Cost of effects",
            labels={"result": "figure"},
        ),
    log:
        f"{OUT}/logs/effects/figure.log",
    params:
        verb="figure effects_cost",
        code=command_code("figure", "npfm.figures.effects_cost"),
        files=lambda wildcards, input, output: [
            *("--table", *input.table),
            *("--changed", *input.changed),
            *("--shown", *input.shown),
            *("-o", *output),
        ],


rule effects:
    input:
        rules.effects_table.output,
        rules.effects_figure.output,
