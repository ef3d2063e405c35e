"""Fit reflectance models to measured materials, render them, and compare."""

import sys

from npfm.run.config import check, prefer_this_python
from npfm.errors import NpfmError
from npfm.run.provenance import digest


configfile: "config.yaml"


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
    material="[^/]+",
    variant="[^/]+",
    scene="[^/]+",
    light="[^/]+",


include: "workflow/rules/materials.smk"
include: "workflow/rules/fits.smk"
include: "workflow/rules/scenes.smk"
include: "workflow/rules/pictures.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/paper_figures_pictures.smk"
include: "workflow/rules/paper_figures_factors.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/reproduction.smk"
include: "workflow/rules/accuracy_cost.smk"
include: "workflow/rules/effects_cost.smk"
include: "workflow/rules/stability.smk"


rule all:
    default_target: True
    input:
        rules.tables.input,
        rules.figures.input,
