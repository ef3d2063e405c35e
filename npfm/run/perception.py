"""What the target `perception` puts beside people's opinions, and where they are."""

from npfm.datasets import opinions
from npfm.errors import NpfmError
from npfm.papers.lavoue2021 import SHOWN
from npfm.run.config import Run
from npfm.run.words import as_input


def opinion_inputs(run: Run) -> list[str]:
    """Return the files of opinions that the configuration names: two, or none.

    Raises
    ------
    NpfmError
        If it names a folder without them, or no variant of the run is of a model that people were
        shown.
    """
    if not run.opinions:
        return []
    [folder] = run.opinions
    distances, classes = (f"{folder}/{name}" for name in (opinions.DISTANCES, opinions.CLASSES))
    opinions.read(distances)
    opinions.classes(classes)
    if not set(SHOWN) & set(run.variants):
        raise NpfmError(
            "config: perceptual: no variant of the run is of a model that people were shown; "
            f"add some of {', '.join(SHOWN)}"
        )
    return [as_input(distances), as_input(classes)]
