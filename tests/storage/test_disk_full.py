"""Every kind of output on a disk that is full: an error of one line, and nothing left behind.

A limit of the size of files stands for the disk: the system then refuses the rest of a write, as
it does when the disk is full, and needs no rights for it.
"""

import gc
import resource
import signal
import subprocess
import sys
from contextlib import contextmanager

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.figures import style
from npfm.fitting import fits, iterations
from npfm.fitting.fits import Fit
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.merl import write_binary
from npfm.reflectance.table import Table
from npfm.rendering import transport
from npfm.storage import pictures

STATES = iterations.Iterations(
    ("ones",), *[np.zeros(9)] * 3, *np.random.default_rng(1).random((4, 9, 90))
)
PICTURE = np.random.default_rng(1).random((32, 32, 3), dtype=np.float32)


def write_figure(path):
    with style.context():
        figure = Figure()
        figure.subplots().plot(PICTURE[0, 0])
        style.save(figure, [path])


def write_scene(path):
    arrays = {
        name: np.arange(10.0) if name == "indptr" else np.arange(700.0)
        for name in transport.Transport.__dataclass_fields__
        if name != "grid"
    }
    transport.save(path, transport.Transport(**arrays, grid=MERL))


WRITERS = {
    "a.binary": lambda path: write_binary(path, Table(np.zeros((3, *MERL.shape)), MERL)),
    "a.exr": lambda path: pictures.write_exr(path, PICTURE),
    "parts.exr": lambda path: pictures.write_exr_parts(path, {"one": PICTURE, "two": PICTURE}),
    "a.png": lambda path: pictures.write_png(path, (255 * PICTURE).astype(np.uint8)),
    "a.csv": lambda path: tables.write(path, pd.DataFrame({"psnr_db": PICTURE.ravel()})),
    "a.npz": lambda path: fits.save(path, Fit("naive", {"H": PICTURE[..., 0]}, MERL)),
    "states.npz": lambda path: iterations.save(path, STATES),
    "figure.pdf": write_figure,
    "figure.png": write_figure,
    "scene": write_scene,
}


@contextmanager
def room_for(size):
    """Refuse files to grow over so many bytes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


# Matplotlib does not close a PDF that it could not write: it is let go of at the end of the test.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("name", WRITERS)
def test_what_does_not_fit_is_absent(name, tmp_path):
    path = tmp_path / name
    WRITERS[name](path)
    size = max(file.stat().st_size for file in [path, *path.rglob("*")] if file.is_file())
    whole = {file: file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}
    # Some libraries keep the last bytes back until they close the file.
    for room in (1, size // 2, size - 1):
        with pytest.raises(NpfmError) as raised, room_for(room):
            WRITERS[name](path)
        message = str(raised.value)
        assert message == f"{path}: no room to write it; free some space, run again"
        assert {f: f.read_bytes() for f in tmp_path.rglob("*") if f.is_file()} == whole
    with room_for(size):
        WRITERS[name](path)
    del raised
    gc.collect()


def test_a_process_killed_while_it_writes_leaves_the_old_file(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("old")
    code = (
        "import os, sys\n"
        "from npfm.storage.files import Kind, replacing\n"
        "with replacing(sys.argv[1], Kind('a table', '.csv', lambda path: True)) as temporary:\n"
        "    temporary.write_text('half')\n"
        "    os.kill(os.getpid(), 9)\n"
    )
    run = subprocess.run([sys.executable, "-c", code, str(path)])
    assert run.returncode == -signal.SIGKILL
    assert path.read_text() == "old"
    left = [file.name for file in tmp_path.iterdir() if file != path]
    assert len(left) == 1 and left[0].startswith(".a.")
