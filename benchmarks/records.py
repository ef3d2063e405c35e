"""What Snakemake has recorded about the jobs of a finished run."""

import json
from base64 import urlsafe_b64decode
from pathlib import Path


def jobs(run):
    """Return the record of each job of a run, by its command.

    A record has the keys of Snakemake's metadata, among them `rule`, `starttime` and `endtime`; and
    `outputs`, the paths of what the job made.
    """
    run = Path(run).resolve()
    root, name = run.parents[1], str(Path(*run.parts[-2:]))
    metadata = root / ".snakemake" / "metadata"
    found = {}
    for path in sorted(metadata.rglob("*")):
        if path.is_file():
            # The name of a record is that of the output, in pieces if it is long.
            coded = "".join(part.removeprefix("@") for part in path.relative_to(metadata).parts)
            output = root / urlsafe_b64decode(coded).decode()
            record = json.loads(path.read_text())
            if output.is_relative_to(root / name) and record["shellcmd"]:
                job = found.setdefault(record["shellcmd"], record | {"outputs": []})
                job["outputs"].append(output)
    return found


def size(path):
    """Bytes of a file, or of all files of a folder; of nothing, 0. A link counts as nothing."""
    if path.is_symlink() or not path.exists():
        return 0
    return path.stat().st_size if path.is_file() else sum(map(size, path.iterdir()))
