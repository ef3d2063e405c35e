"""``npfm export``."""

import argparse

from npfm.commands.outputs import Output
from npfm.errors import NpfmError
from npfm.exports import registry
from npfm.exports.sources import Source
from npfm.storage.files import check_replaceable

#: What a digest covers beside this file (`npfm.run.provenance`); the format's own module, and that
#: of the model, are named by who runs it.
CODE = ("npfm.commands.outputs", "npfm.exports.registry")
EXAMPLE = """\
examples:
  python -m npfm export chrome.npz --to merl -o chrome-fitted.binary
  python -m npfm export chrome.npz --to csv -o chrome.csv
  python -m npfm export chrome.npz --to bsdf --views 32 --size 96 -o chrome.bsdf
docs/exports.md says which program reads what, and what a format cannot say.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    known = registry.formats().items()
    parser.epilog = "formats:\n" + "".join(_line(*named) for named in known) + f"\n{EXAMPLE}"
    parser.add_argument(
        "fits", nargs="+", metavar="fit", help="fit (.npz), or a table where a format takes one"
    )
    parser.add_argument("--to", required=True, metavar="FORMAT", help="which of these formats")
    # What may be written there depends on the format: `run` checks it first.
    parser.add_argument("-o", "--output", type=Output, required=True, help="what to write")
    for setting, meaning in _settings().items():
        parser.add_argument(f"--{setting}", type=int, metavar="N", help=meaning)


def run(arguments: argparse.Namespace) -> str | None:
    """Write the fits in the format; what there is to say of it, in a line."""
    known = registry.declared(arguments.to)
    given = {name: getattr(arguments, name) for name in _settings()}
    given = {name: value for name, value in given.items() if value is not None}
    if wrong := [name for name in given if name not in known.settings]:
        raise NpfmError(f"--{wrong[0]} is not a setting of '{arguments.to}'; leave it out")
    module = known.load()
    check_replaceable(arguments.output, module.KIND)
    sources = [Source(path) for path in arguments.fits]
    registry.check(arguments.to, sources)
    return module.write(arguments.output, sources, **given)


def _settings() -> dict[str, str]:
    """Settings that only some formats have, with what they mean."""
    meanings: dict[str, dict[str, list[str]]] = {}
    for name, known in registry.formats().items():
        for setting, meaning in known.settings.items():
            meanings.setdefault(setting, {}).setdefault(meaning, []).append(name)
    return {
        setting: "; ".join(f"of {', '.join(names)}: {meaning}" for meaning, names in said.items())
        for setting, said in meanings.items()
    }


def _line(name: str, known: registry.Format) -> str:
    """What a format is and is made from."""
    made = f"fits of {', '.join(known.models)}" if known.models else "any fit"
    if known.tables:
        made += " or table"
    return f"  {name:15}{known.suffix or 'folder':10}{known.about}\n{'':27}from {made}\n"
