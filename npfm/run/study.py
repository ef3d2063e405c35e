"""Fits beyond the variants of a run, for a question of their own."""

from npfm.run.config import Run


def fit_folders(run: Run, study: Run, folder: str) -> dict[str, str]:
    """Folder of the fits of each variant of a study; equal settings are fitted once.

    Parameters
    ----------
    run : Run
        What the study goes with; fits that it has are taken from there.
    study : Run
        The same run with variants of its own.
    folder : str
        Where the other fits of the study go.
    """
    folders = {v.options: f"{run.folder}/fits/{v.name}" for v in run.variants.values()}
    for variant in study.variants.values():
        folders.setdefault(variant.options, f"{folder}/fits/{variant.name}")
    return {variant.name: folders[variant.options] for variant in study.variants.values()}
