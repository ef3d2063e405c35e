"""Folders of measured tables, one file a material."""

from pathlib import Path

from npfm.errors import NpfmError, suggest


def materials(folder: str | Path, suffix: str, what: str) -> list[str]:
    """Names of the files in a folder that end in a suffix, sorted.

    Parameters
    ----------
    folder : str or Path
    suffix, what : str
        How the files end, with the dot, and whose they are, for messages.

    Raises
    ------
    NpfmError
        If there is no such folder, or a file in it would be missed for its capitals.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise NpfmError(f"{folder}: no such folder; give the folder of the {what} {suffix} files")
    # A leading dot marks a file that is still being written (`npfm.storage.files.replacing`).
    files = [p for p in folder.iterdir() if p.suffix.lower() == suffix and p.name[:1] != "."]
    for file in files:
        if file.suffix != suffix:
            raise NpfmError(f"{file}: rename it to {file.stem}{suffix}, in lower case")
    return sorted(file.stem for file in files)


def path(folder: str | Path, name: str, suffix: str, what: str) -> Path:
    """Path of a material's file.

    Raises
    ------
    NpfmError
        If folder or file are absent.
    """
    file = Path(folder) / f"{name}{suffix}"
    if not file.is_file():
        raise NpfmError(f"{file}: no such file; {suggest(name, materials(folder, suffix, what))}")
    return file
