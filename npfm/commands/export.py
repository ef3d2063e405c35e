"""``npfm export``."""

import argparse

from npfm.commands.outputs import Output
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
docs/exports.md says which program reads what, and what a format cannot say.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    known = registry.formats().items()
    parser.epilog = "formats:\n" + "".join(_line(*named) for named in known) + f"\n{EXAMPLE}"
    parser.add_argument("fits", nargs="+", metavar="fit", help="fit (.npz)")
    parser.add_argument("--to", required=True, metavar="FORMAT", help="which of these formats")
    # What may be written there depends on the format: `run` checks it first.
    parser.add_argument("-o", "--output", type=Output, required=True, help="what to write")


def run(arguments: argparse.Namespace) -> str | None:
    """Write the fits in the format; what there is to say of it, in a line."""
    module = registry.declared(arguments.to).load()
    check_replaceable(arguments.output, module.KIND)
    sources = [Source(path) for path in arguments.fits]
    registry.check(arguments.to, sources)
    return module.write(arguments.output, sources)


def _line(name: str, known: registry.Format) -> str:
    """What a format is and is made from."""
    made = f"fits of {', '.join(known.models)}" if known.models else "any fit"
    if known.tables:
        made += " or table"
    return f"  {name:12}{known.suffix or 'folder':10}{known.about}\n{'':24}from {made}\n"
