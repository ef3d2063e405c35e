"""Whether the published numbers of Ngan et al. 2005 are of MERL's channels scaled or as stored.

    python benchmarks/ngan.py results/neural --variants cook-torrance-published

Prints, for the parameters scaled as the tables are (which is how the run's fits have them) and as
they were published: the median of the logarithm of fit over table in each channel, over the samples
of the objective; and the PSNR in the run's scenes, mean over the materials that have such a fit.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from npfm.evaluation.metrics import mean_db, psnr_or_gap
from npfm.fitting import fits, registry
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, channel_samples
from npfm.fitting.parametric.ngan import CHANNEL_WEIGHT
from npfm.reflectance.merl import read_binary
from npfm.reflectance.table import Table
from npfm.rendering import transport
from npfm.rendering.transport import Transport, columns, pictures

FORMS = ("scaled", "as published")


def as_published(fit: Fit) -> Fit:
    """The fit without the scaling of the channels."""
    scaled = {name: fit.parameters[name] / CHANNEL_WEIGHT for name in ("rho_d", "rho_s")}
    return replace(fit, parameters={**fit.parameters, **scaled})


def bias(fitted: Table, measured: Table) -> list[float]:
    """Median of log(fit / measurement) in each channel."""
    found = []
    for channel in range(3):
        samples = channel_samples(measured, channel, Objective())
        counted = (samples.weight > 0) & (measured.values[channel] > 0)
        ratio = fitted.values[channel][counted] / measured.values[channel][counted]
        found.append(float(np.median(np.log(np.maximum(ratio, 1e-9)))))
    return found


def decibels(scenes: list[Transport], measured: Table, shown: list[Table]) -> list[list[float]]:
    """PSNR of each table in each scene, shape (tables, scenes)."""
    values = columns([measured, *(table.where_measured(measured) for table in shown)])
    found = []
    for matrix in scenes:
        reference, *compared = pictures(matrix, values)
        found.append([psnr_or_gap(p, reference, matrix.foreground)[0] for p in compared])
    return np.transpose(found).tolist()


def main() -> None:
    """Print a row for each variant and form."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("run", type=Path, help="folder of a run")
    parser.add_argument("--variants", nargs="+", required=True)
    parser.add_argument("--scenes", nargs="+", default=["A", "B", "C", "D"])
    a = parser.parse_args()
    scenes = [transport.load(a.run / "scenes" / name) for name in a.scenes]
    print(f"{'':40} materials     red   green    blue    PSNR (dB)")
    for variant in a.variants:
        found, biases = [], []
        for path in sorted((a.run / "fits" / variant).glob("*.npz")):
            measured, fit = read_binary(a.run / f"materials/{path.stem}.binary"), fits.load(path)
            model = registry.model(fit.model)
            shown = [model.tabulate(form) for form in (fit, as_published(fit))]
            found.append(decibels(scenes, measured, shown))
            biases.append([bias(table, measured) for table in shown])
        for k, form in enumerate(FORMS):
            red, green, blue = np.median(np.array(biases)[:, k], axis=0)
            mean = mean_db(np.array(found)[:, k])
            print(
                f"{f'{variant}, {form}':40} {len(found):9} {red:+7.2f} {green:+7.2f} {blue:+7.2f}"
                f" {mean:9.2f}"
            )


if __name__ == "__main__":
    main()
