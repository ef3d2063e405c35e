"""Fit reflectance models to measured materials, render them, and compare."""

import sys

from npfm.declarations import NAME_PATTERN
from npfm.errors import NpfmError
from npfm.run.config import check, prefer_this_python
from npfm.run.names import any_of
from npfm.run.provenance import command_code
from npfm.run.words import as_input, option, path_word, words


configfile: f"{workflow.basedir}/config.yaml"


report: "workflow/report/workflow.rst"


try:
    RUN = check(config)
except NpfmError as error:
    sys.exit(f"npfm: {error}")

for warning in RUN.warnings:
    print(f"npfm: warning: {warning}", file=sys.stderr)

OUT = RUN.folder
prefer_this_python()


wildcard_constraints:
    material=NAME_PATTERN,
    variant=NAME_PATTERN,
    scene=NAME_PATTERN,
    light=NAME_PATTERN,


include: "workflow/rules/npfm.smk"
include: "workflow/rules/materials.smk"
include: "workflow/rules/fits.smk"
include: "workflow/rules/scenes.smk"
include: "workflow/rules/pictures.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/quality.smk"
include: "workflow/rules/paper_figures.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/fidelity.smk"
include: "workflow/rules/gallery.smk"
include: "workflow/rules/reproduction.smk"
include: "workflow/rules/power_iterations.smk"
include: "workflow/rules/stability.smk"


if not RUN.grid.anisotropic:

    include: "workflow/rules/accuracy_cost.smk"
    include: "workflow/rules/basis.smk"
    include: "workflow/rules/video.smk"
    include: "workflow/rules/effects_cost.smk"
    include: "workflow/rules/exports.smk"
    include: "workflow/rules/factorisation.smk"
    include: "workflow/rules/importance.smk"
    include: "workflow/rules/bounces.smk"
    include: "workflow/rules/blends.smk"
    include: "workflow/rules/perception.smk"
    include: "workflow/rules/psnr_level.smk"
    include: "workflow/rules/shared_lobes.smk"
    include: "workflow/rules/uniqueness.smk"
    include: "workflow/rules/where.smk"


rule all:
    default_target: True
    input:
        rules.tables.input,
        rules.quality_table.output,
        rules.quality_summary.output,
        rules.figures.input,
        rules.fidelity.input if RUN.grid.anisotropic else [],
        rules.power_iterations.input if RUN.grid.anisotropic else [],
