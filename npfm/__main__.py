"""``python -m npfm <verb>``: what the workflow's rules call, and a person can use alone."""

import argparse
import importlib
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import NoReturn, TextIO

# One job, one core, whatever the environment asks for: the workflow runs jobs side by side, and a
# sum that several threads share would round differently. Libraries read these when they are loaded.
for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_variable] = "1"

from npfm.commands import outputs  # noqa: E402
from npfm.errors import NpfmError, NpfmWarning  # noqa: E402
from npfm.storage.signals import stopping_cleanly  # noqa: E402

VERBS = {
    "material": "write one material of a dataset as a MERL .binary or UTIA .bin file",
    "fit": "fit a model to a MERL .binary or UTIA .bin file",
    "factor": "factor a table or a formula, to be sampled",
    "tabulate": "write a fit as a MERL .binary or UTIA .bin file",
    "export": "write a fit in a format of other programs",
    "edit": "make the microfacets of a fit rougher or smoother",
    "texture": "write fits of many materials as one small EXR picture",
    "light": "convert a light probe, or generate a light, as a lat-long EXR",
    "scene": "build the transport matrix of a scene",
    "render": "render a table or a fit in a scene",
    "interreflect": "render the light that objects of a scene reflect onto each other",
    "vary": "render an object whose material varies from place to place",
    "compare": "PSNR of pictures against a reference, and other metrics",
    "tables": "gather fits and pictures into the tables of a run",
    "quality": "compare the fits of a run with the measurements by many metrics",
    "figure": "draw a figure from the tables of a run",
    "video": "a light turned around a material, and its fit converging: pages and animations",
    "gallery": "make the pages of a gallery that a browser opens from disk",
    "reproduction": "put the paper's claims to the tables of a run, as a page of Markdown",
    "blends": "an object that changes between four materials, blended in several ways",
    "bounces": "a still life of five materials, by each way of choosing the directions of paths",
    "effects-cost": "what effects cost and change, switched off and on",
    "accuracy-cost": "tables of what accuracy costs in time",
    "psnr-level": "the same fits by other foregrounds, resolutions and turns of the light",
    "factorisation": "how accurate the factors of tables and formulas are",
    "importance": "how noisy a material is in a light, by the way directions are chosen",
    "basis": "a few curves that the factors of many materials have in common, and fits in them",
    "uniqueness": "how far apart the factors lie that fits of one material end at",
    "shared-lobes": "tables of what lobes that the channels share gain, and of sampling by D",
    "power-iterations": "tables of what power iterations find, and how well and fast",
    "perception": "how well metrics agree with what people see",
    "stability": "fit hard inputs, and gather how that went",
}


def _command(verb: str) -> ModuleType:
    """Return the module of a key of `VERBS`; only that one is imported, to start quickly."""
    return importlib.import_module(f"npfm.commands.{verb.replace('-', '_')}")


class _Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line, like all others."""

    def error(self, message: str) -> NoReturn:
        raise NpfmError(f"{message}; see {self.prog} --help")


@contextmanager
def _warnings_in_one_line(verb: str) -> Iterator[None]:
    """Print what is meant for the user without the line of code that warns."""
    with warnings.catch_warnings():
        shown = warnings.showwarning

        def show(
            message: Warning | str,
            category: type[Warning],
            filename: str,
            lineno: int,
            file: TextIO | None = None,
            line: str | None = None,
        ) -> None:
            if issubclass(category, NpfmWarning):
                print(f"npfm {verb}: warning: {message}", file=sys.stderr)
            else:
                shown(message, category, filename, lineno, file, line)

        warnings.showwarning = show
        yield


def main(arguments: list[str] | None = None) -> int:
    """Run a verb; return the exit code (1 for a mistake in the input, told in one line)."""
    arguments = sys.argv[1:] if arguments is None else arguments
    # A list that is too long for a command line is in a file, a word a line: @file.
    parser = _Parser(
        prog="python -m npfm", description=__doc__.split("\n")[0], fromfile_prefix_chars="@"
    )
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="verb")
    for verb, summary in VERBS.items():
        chosen = verbs.add_parser(
            verb,
            help=summary,
            description=summary[0].upper() + summary[1:] + ".",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        if arguments[:1] == [verb]:
            _command(verb).add_arguments(chosen)
    try:
        parsed = parser.parse_args(arguments)
        outputs.check(parsed)
        with stopping_cleanly(), _warnings_in_one_line(parsed.verb):
            said = _command(parsed.verb).run(parsed)
    except (NpfmError, OSError) as error:
        named = [verb for verb in arguments[:1] if verb in VERBS]
        print(f"{' '.join(['npfm', *named])}: {error}", file=sys.stderr)
        return 1
    except MemoryError as error:
        print(f"npfm {parsed.verb}: too little memory; ask for less ({error})", file=sys.stderr)
        return 1
    if written := outputs.written(parsed):
        names = ", ".join(map(str, written))
        print(f"npfm {parsed.verb}: wrote {names}{f': {said}' if said else ''}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
