"""Ten thousand materials are a matter of time only: no command outgrows what a system allows."""

import hashlib
import re

from npfm.__main__ import main
from npfm.run.words import words

#: Bytes of the longest argument that Linux takes; a job's command is one.
MOST = 2**17
#: With names of 100 letters, as many bytes as 5000 materials with names of 14: more than half of
#: what is allowed.
MATERIALS = 700


def test_no_command_is_longer_than_the_system_allows(fresh):
    """Not run: seconds of fits for each. Asked for are rules that gather."""
    brdfs = fresh.folder / "brdfs"
    brdfs.mkdir()
    # Not periodic, which Snakemake takes for a loop of rules.
    names = [hashlib.sha512(bytes([n % 256, n // 256])).hexdigest()[:100] for n in range(MATERIALS)]
    for name in names:
        (brdfs / f"{name}.binary").touch()
    accuracy_cost = fresh.config["accuracy_cost"] | {"materials": names}
    fresh.configure(
        data="",
        dataset={"kind": "merl", "path": "brdfs", "materials": ["*"]},
        scenes={"A": fresh.config["scenes"]["A"]},
        variants=["independent-g"],
        accuracy_cost=accuracy_cost,
    )
    traces = "results/tiny/accuracy_cost/traces.csv"
    run = fresh.snakemake("--dry-run", "--printshellcmds", "tables", "texture", traces)
    assert run.returncode == 0, run.stdout[-2000:] + run.stderr[-2000:]
    commands = re.findall(r"python -m npfm .*$", run.stdout + run.stderr, re.MULTILINE)
    assert len(commands) > 4 * MATERIALS
    assert max(map(len, commands)) < MOST / 2
    for verb in ("tables psnr", "tables fits", "texture", "accuracy-cost traces"):
        [gathers] = {line for line in commands if f"npfm {verb} " in line and "@" in line}
        for path in re.findall(r"@(\S+)", gathers):
            assert len((fresh.folder / path).read_text().split()) == MATERIALS


def test_a_verb_reads_its_words_from_a_file(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    [word] = words(f"{'x' * 100}{number}.npz" for number in range(200))
    assert main(["texture", word, "-o", "texture.exr"]) == 1
    assert capsys.readouterr().err.startswith(f"npfm texture: {'x' * 100}0.npz: ")
    assert main(["texture", "@absent.txt", "-o", "texture.exr"]) == 1
    assert "absent.txt" in capsys.readouterr().err
