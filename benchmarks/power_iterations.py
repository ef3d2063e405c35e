"""Power iterations here and in the C++ of the authors of the paper (Dupuy et al. 2015).

    python benchmarks/power_iterations.py dj_brdf/dj_brdf.h \
        results/neural-10/materials/*.binary

`dj_brdf.h` is in the repository jdupuy/dj_brdf on GitHub; what is asked of it is
`djb::tabular(merl, 90)`, as of commit 54a4603. It is compiled with `c++ -O3`, in single
precision, as it comes.

Seconds are of processor time on one thread, medians of repeats in which both sides take turns;
reading the table, compiling, and on either side the first time are not in them:

D           theirs: 89 samples of luminance straight back, the matrix, 4 iterations, the scale of D;
            ours: the matrix of all channels and iterations to a change of 1e-10, of weighted
            samples that have been made
D and F     theirs: and sigma, and F of red, green and blue as means of ratios at a phi_d of 90
            degrees, in at most 90 cells a theta_d; ours: and sigma, and F of each from every cell
all         theirs: and the tables of slopes to sample by; ours: the whole fit, so also weights
            and medians of all cells, and the record with the objective of the result
once        ours, the first fit less the median: imports, and what depends on the grid alone

How far they are apart: the share of the area of microfacets that is elsewhere (half of the integral
of |D - D'| cos(theta_h), for D and D' normalised), first as functions of theta_h, then sample by
sample: theirs are at theta_h = (k / 89)^2 of 90 degrees, and read there what the table has around
((k + 1/2) / 90)^2, where ours are. F: the mean difference over its mean, to a theta_d of 80
degrees, both held at 1 as theirs is.

They read tables differently, too: theirs takes directions within 0.26 degrees of the normal for the
normal (`xyz_to_theta_phi`), and so one value for the first five bins of theta_h; one phi_d in place
of all; and luminance in place of the sum of the channels. The last D is of the same samples from a
table in which that is so.
"""

import argparse
import os
import shutil
import subprocess
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")

import numpy as np
from numpy.typing import NDArray

from npfm.commands.numbers import whole
from npfm.errors import NpfmError
from npfm.evaluation.perceived import LUMINANCE
from npfm.fitting import registry
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, Samples, channel_samples, fold
from npfm.fitting.power_iterations.eigenproblem import distribution
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.merl import read_binary
from npfm.reflectance.slopes import bands, normalised
from npfm.reflectance.table import CHANNELS, INVALID, Table

Array = NDArray[np.float64]

DRIVER = r"""
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>

static std::clock_t distributed, fitted;

// The header tells what it has finished.
static void told(const char *message)
{
    if (std::strstr(message, "Slope PDF")) distributed = std::clock();
    if (std::strstr(message, "Fresnel")) fitted = std::clock();
}

#define DJB_LOG(format, ...) told(format)
#define DJ_BRDF_IMPLEMENTATION 1
#include "dj_brdf.h"

static void print(double number) { std::printf("%.9e ", number); }

int main(int, char **arguments)
{
    const int bins = 90;
    const double right = std::acos(0.0);
    const djb::merl material(arguments[1]);

    while (std::getchar() != EOF) {
        const std::clock_t began = std::clock();
        const djb::tabular made(material, bins);
        const std::clock_t ended = std::clock();
        for (std::clock_t end : {distributed, fitted, ended})
            print(double(end - began) / CLOCKS_PER_SEC);
        for (int k = 0; k < bins; ++k) {
            const double root = (k + 0.5) / bins;
            print(made.ndf(djb::vec3(djb::float_t(root * root * right), djb::float_t(0))));
        }
        for (int k = 0; k < bins; ++k) print(made.get_p22v()[k]);
        for (int k = 0; k < bins; ++k) {
            const djb::vec3 F = made.fresnel(djb::float_t(std::cos((k + 0.5) / bins * right)));
            print(F.x), print(F.y), print(F.z);
        }
        std::printf("\n");
        std::fflush(stdout);
    }
    return 0;
}
"""
TIMES = 3
#: Bins of theta_d that are compared.
COMPARED = 80
#: Bins of theta_h at whose half vectors theirs is at the normal: cosines above 0.99999.
AT_NORMAL = 5
SETTINGS = {
    "paper, mean": {"kernel": "paper", "fresnel": "mean"},
    "defaults": {},
}


@dataclass(frozen=True)
class Extracted:
    """What either side makes of a table.

    Parameters
    ----------
    seconds : ndarray, shape (3,)
        Of D, of D and F, and of all.
    D : ndarray, shape (90,)
        At the centres of MERL's bins, in any scale.
    samples : ndarray, shape (90,)
        D where it was sampled for each bin.
    F : ndarray, shape (3, 90)
        At the centres of MERL's bins.
    """

    seconds: Array
    D: Array
    samples: Array
    F: Array


def compiled(header: str | Path, folder: str | Path) -> Path:
    """Compile the authors' header with what asks it.

    Raises
    ------
    NpfmError
        If the header is not there or does not have what is asked of it, or there is no compiler.
    """
    compiler, folder = shutil.which("c++"), Path(folder)
    try:
        shutil.copyfile(header, folder / "dj_brdf.h")
    except OSError as error:
        raise NpfmError(
            f"{header}: {error.strerror}; give dj_brdf.h of GitHub's jdupuy/dj_brdf"
        ) from error
    if compiler is None:
        raise NpfmError("no C++ compiler: no c++ is on the PATH; install one, such as g++")
    (folder / "driver.cpp").write_text(DRIVER)
    call = [compiler, "-O3", "-std=c++11", "-w", "driver.cpp", "-o", "driver"]
    done = subprocess.run(call, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        [error, *_] = [line for line in done.stderr.splitlines() if "error" in line] or ["error"]
        raise NpfmError(
            f"{header}: not compiled ({error}); give dj_brdf.h of GitHub's jdupuy/dj_brdf, "
            "as of commit 54a4603"
        )
    return folder / "driver"


class Authors:
    """The authors' program for one table, which extracts as often as it is asked to."""

    def __init__(self, program: Path, table: str | Path) -> None:
        call = [program, Path(table).resolve()]
        pipe = subprocess.PIPE
        self.path = table
        self.process = subprocess.Popen(call, stdin=pipe, stdout=pipe, text=True)

    def __enter__(self) -> "Authors":
        return self

    def __exit__(self, *_: object) -> None:
        self.process.communicate()

    def __call__(self) -> Extracted:
        """Extract once.

        Raises
        ------
        NpfmError
            If the program ends instead.
        """
        with suppress(BrokenPipeError):
            self.process.stdin.write("\n")
            self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise NpfmError(f"{self.path}: the authors' program ended early")
        return parsed(line)


def parsed(line: str) -> Extracted:
    """What a line of the driver says."""
    numbers, bins = np.array(line.split(), dtype=float), MERL.theta_h_bins
    seconds, D, slopes, F = np.split(numbers, np.cumsum([TIMES, bins, bins]))
    # The last slope is 0, and so is its cosine.
    cosine = np.cos((np.arange(bins - 1) / (bins - 1)) ** 2 * np.pi / 2)
    return Extracted(seconds, D, np.append(slopes[:-1] / cosine**4, 0.0), F.reshape(bins, 3).T)


def folded(table: Table) -> list[Samples]:
    """What our fits begin with."""
    channels = range(len(CHANNELS))
    return [fold(channel_samples(table, channel, Objective())) for channel in channels]


def as_they_read(table: Table) -> Table:
    """Return the table in which our D has the samples that theirs has."""
    measured = table.valid.all(axis=0)
    grey = np.where(measured, np.tensordot(LUMINANCE, table.values, 1), INVALID)
    grey[:AT_NORMAL, 0] = grey[0, 0]
    grey[:, 0] = grey[:, 0, :1]
    return Table(np.stack([grey] * len(CHANNELS)), table.grid)


def fitted(table: Table, settings: dict[str, str]) -> tuple[Fit, float]:
    """Return a fit of ours, and its seconds."""
    began = time.process_time()
    fit = registry.model("power-iteration").fit(table, Objective(), None, 1, **settings)
    return fit, time.process_time() - began


def ours(table: Table, samples: list[Samples], settings: dict[str, str]) -> Extracted:
    """Look for D, and then fit."""
    began = time.process_time()
    shape(samples, settings)
    first = time.process_time() - began
    fit, seconds = fitted(table, settings)
    factors = sum(trace.seconds[-1] for record in fit.records for trace in record.traces)
    parameters = {key: array.astype(float) for key, array in fit.parameters.items()}
    [D], F = parameters["D"], parameters["rho_s"][:, None] * parameters["F"]
    return Extracted(np.array([first, factors, seconds]), D, D, F)


def shape(samples: list[Samples], settings: dict[str, str]) -> Array:
    """Our D alone."""
    D, _, _ = distribution(samples, settings.get("kernel", "consistent"))
    return D


def moved(D: Array, other: Array) -> float:
    """Share of the area of microfacets that two distributions have at other theta_h."""
    apart = np.abs(normalised(D, MERL) - normalised(other, MERL))
    return float(np.pi * np.sum(bands(MERL) * np.cos(MERL.theta_h) * apart))


def unlike(F: Array, other: Array) -> float:
    """Mean difference of Fresnel factors over the mean of the first."""
    one, two = (np.minimum(array[:, :COMPARED], 1.0) for array in (F, other))
    return float(np.abs(one - two).mean() / one.mean())


def main() -> None:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("header", help="dj_brdf.h")
    parser.add_argument("tables", nargs="+", help="MERL tables (.binary)")
    parser.add_argument("--repeats", type=whole(1), default=9)
    a = parser.parse_args()
    try:
        with TemporaryDirectory() as folder:
            measure(compiled(a.header, folder), a.tables, a.repeats)
    except NpfmError as error:
        raise SystemExit(f"power_iterations: {error}") from None


def measure(program: Path, paths: list[str], repeats: int) -> None:
    """Print a line for each table and settings of ours."""
    print(f"{'ms':31} theirs: D  D and F    all  ours: D  D and F    all  ", end="")
    print("theirs / ours        F     D by sample    alike")
    once = []
    for path in paths:
        table = read_binary(path)
        _, first = fitted(table, {})
        samples, alike = folded(table), folded(as_they_read(table))
        with Authors(program, path) as authors:
            authors()
            for name, settings in SETTINGS.items():
                ours(table, samples, settings)
                pairs = [(authors(), ours(table, samples, settings)) for _ in range(repeats)]
                once.append(first - np.median([own.seconds[-1] for _, own in pairs]))
                line = row(pairs, shape(alike, settings))
                print(f"{Path(path).stem:18} {name:12} {line}", flush=True)
    print(f"ours, once: {1e3 * once[len(SETTINGS) - 1]:.0f} ms")


def row(pairs: list[tuple[Extracted, Extracted]], alike: Array) -> str:
    """Seconds of both sides, their ratios, and how far the last two, and D `alike`, are apart."""
    seconds = np.median([[theirs.seconds, own.seconds] for theirs, own in pairs], axis=0)
    theirs, own = pairs[-1]
    apart = (
        unlike(own.F, theirs.F),
        moved(theirs.D, own.D),
        moved(theirs.samples, own.D),
        moved(theirs.samples, alike),
    )
    return " ".join(
        [f"{number:8.1f}" for number in 1e3 * seconds.ravel()]
        + [f"{ratio:6.2f}" for ratio in seconds[0] / seconds[1]]
        + [f"{share:8.4f}" for share in apart]
    )


if __name__ == "__main__":
    main()
