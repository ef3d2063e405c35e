"""``npfm fit``, ``npfm tabulate`` and ``npfm material``, as a person calls them."""

import os
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from npfm.__main__ import main
from npfm.datasets import synthetic
from npfm.fitting import fits, iterations
from npfm.fitting.objective import Objective
from npfm.models import bivariate
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.merl import read_binary, write_binary
from npfm.reflectance.table import Table

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def felt(tmp_path_factory):
    """A MERL file of a simple material: a lobe on a diffuse part, with gaps."""
    rng = np.random.default_rng(4)
    value = 0.2 + np.exp(-8 * MERL.theta_h[:, None, None] ** 2) * rng.uniform(1, 1.1, MERL.shape)
    present = MERL.above_horizon & (rng.random(MERL.shape) > 0.01)
    colours = np.array([1.0, 0.7, 0.4])[:, None, None, None]
    path = tmp_path_factory.mktemp("brdfs") / "felt.binary"
    write_binary(path, Table(np.where(present, value * colours, -1.0)))
    return path


@pytest.fixture
def nowhere_to_cache(tmp_path):
    """Environment of a copy of the package beside which, as anywhere, no folder can be made."""
    shutil.copytree(ROOT / "npfm", tmp_path / "npfm", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "npfm" / "fitting" / "factors" / "__pycache__").touch()
    (tmp_path / "file").touch()
    environment = {key: value for key, value in os.environ.items() if key != "HOME"}
    folder = str(tmp_path / "file" / "cache")
    return (
        environment
        | dict.fromkeys(("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"), folder)
        | {"PYTHONPATH": str(tmp_path)}
    )


def run(capsys, *arguments):
    """Exit code and what was said on the two outputs."""
    code = main([str(argument) for argument in arguments])
    said = capsys.readouterr()
    return code, said.out, said.err


def refused(capsys, folder, *arguments):
    """The one line with which a call is refused, and proof that it left nothing behind."""
    before = sorted(folder.rglob("*"))
    code, out, err = run(capsys, *arguments)
    assert (code, out) == (1, "")
    lines = err.splitlines()
    assert len(lines) == 1, err
    assert lines[0].startswith(f"npfm {arguments[0]}: ")
    assert sorted(folder.rglob("*")) == before
    return lines[0]


def test_fit_writes_the_fit_and_its_record(capsys, tmp_path, felt):
    path = tmp_path / "new" / "felt.npz"
    assert run(capsys, "fit", felt, "--model", "bivariate", "-o", path)[:2] == (0, "")
    fit, direct = fits.load(path), bivariate.fit(read_binary(felt), Objective(), None, 1)
    assert fit.model == "bivariate"
    assert np.array_equal(fit.parameters["B"], direct.parameters["B"])
    record = fits.load_record(path)
    assert (record["model"], record["bytes"]) == ("bivariate", 97200)
    for found, expected in zip(record["channels"], direct.records, strict=True):
        assert found.channel == expected.channel
        assert found.objective == expected.objective
        assert found.objective_floor == expected.objective_floor
    assert sorted(p.name for p in path.parent.iterdir()) == ["felt.json", "felt.npz"]


def test_options_reach_the_objective(capsys, tmp_path, felt):
    path, table = tmp_path / "felt.npz", read_binary(felt)
    options = ["--no-compressive", "--max-angle", "70", "--cells", "solid-angle"]
    assert run(capsys, "fit", felt, "--model", "bivariate", *options, "-o", path)[0] == 0
    direct = bivariate.fit(table, Objective(False, 70.0, "solid-angle"), None, 1)
    assert np.array_equal(fits.load(path).parameters["B"], direct.parameters["B"])
    default = bivariate.fit(table, Objective(), None, 1)
    assert not np.array_equal(default.parameters["B"], direct.parameters["B"])


@pytest.mark.parametrize("solver", ["awls", "gauss-newton"])
def test_options_reach_the_solver(capsys, tmp_path, felt, solver):
    path = tmp_path / "felt.npz"
    options = ["--solver", solver, "--max-iterations", "1", "--tolerance", "1e-12"]
    assert run(capsys, "fit", felt, "--model", "naive", *options, "-o", path)[0] == 0
    for channel in fits.load_record(path)["channels"]:
        assert channel.status == "iteration cap"
        assert len(channel.traces[0].objective) == 2


def test_rank_reaches_the_model(capsys, tmp_path, felt):
    path = tmp_path / "felt.npz"
    assert run(capsys, "fit", felt, "--model", "low-rank-b", "--rank", 2, "-o", path)[0] == 0
    assert fits.load(path).parameters["U"].shape[-1] == 2


def test_words_reach_the_model(capsys, tmp_path, felt):
    found = set()
    for kernel in ("consistent", "paper"):
        path = tmp_path / f"{kernel}.npz"
        call = "fit", felt, "--model", "power-iteration", "--kernel", kernel, "-o", path
        assert run(capsys, *call)[0] == 0
        found.add(fits.load(path).parameters["D"].tobytes())
    assert len(found) == 2


@pytest.mark.parametrize(
    ("variant", "option", "value", "said"),
    [
        ("naive", "--rank", 2, "--rank is not a setting of 'naive'"),
        ("low-rank-b", "--starts", 2, "--starts is not a setting of 'low-rank-b'"),
        ("low-rank-b", "--rank", 0, "give a rank from 1 to 90"),
        ("independent-g", "--starts", 9, "give a number from 1 to 8"),
        ("naive", "--kernel", "paper", "--kernel is not a setting of 'naive'"),
        ("power-iteration", "--kernel", "papers", "invalid choice: 'papers'"),
    ],
)
def test_settings_of_other_models_are_refused(capsys, tmp_path, felt, variant, option, value, said):
    call = "fit", felt, "--model", variant, option, value, "-o", tmp_path / "felt.npz"
    assert said in refused(capsys, tmp_path, *call)


def test_iterations_are_written_beside_the_fit(capsys, tmp_path, felt):
    call = "fit", felt, "--model", "g-from-d", "--max-iterations", 1, "-o", tmp_path / "felt.npz"
    code, _, said = run(capsys, *call, "--iterations", tmp_path / "states.npz")
    assert code == 0 and "states.npz" in said
    assert {path.name for path in tmp_path.iterdir()} == {"felt.npz", "felt.json", "states.npz"}
    assert iterations.load(tmp_path / "states.npz").names == ("slices", "slices-flat")


def test_iterations_of_a_model_that_runs_none_are_refused(capsys, tmp_path, felt):
    call = "fit", felt, "--model", "bivariate", "-o", tmp_path / "felt.npz"
    said = refused(capsys, tmp_path, *call, "--iterations", tmp_path / "states.npz")
    assert "'bivariate' runs no iterations; leave --iterations out" in said


def test_tabulate_writes_the_fit_as_a_merl_file(capsys, tmp_path, felt):
    fit, table = tmp_path / "felt.npz", tmp_path / "fitted.binary"
    run(capsys, "fit", felt, "--model", "bivariate", "-o", fit)
    assert run(capsys, "tabulate", fit, "-o", table)[:2] == (0, "")
    found, expected = read_binary(table), bivariate.tabulate(fits.load(fit))
    assert (found.valid == MERL.above_horizon).all()
    np.testing.assert_allclose(
        found.values[found.valid], expected.values[found.valid], rtol=1e-15, atol=0
    )


def test_unknown_names_are_answered_with_near_ones(capsys, tmp_path, felt):
    output = tmp_path / "x.npz"
    line = refused(capsys, tmp_path, "fit", felt, "--model", "independant-g", "-o", output)
    assert "independent-g" in line
    line = refused(
        capsys, tmp_path, "fit", felt, "--model", "naive", "--solver", "als", "-o", output
    )
    assert "awls" in line


def broken(kind, path, felt):
    """Write a file with one thing wrong."""
    content = bytearray(felt.read_bytes())
    match kind:
        case "absent":
            return
        case "truncated":
            del content[-1000:]
        case "too long":
            content += bytes(8)
        case "other dimensions":
            content[:12] = struct.pack("<3i", 90, 90, 360)
        case "not a number":
            content[8012:8020] = struct.pack("<d", float("nan"))
        case "both infinities":
            content[8012:8028] = struct.pack("<2d", float("inf"), float("-inf"))
        case "an empty channel":
            content[-8 * MERL.size :] = np.full(MERL.size, -1.0).tobytes()
    path.write_bytes(content)


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        ("absent", "no such file"),
        ("truncated", "34991012 bytes"),
        ("too long", "34992020 bytes"),
        ("other dimensions", "90 x 90 x 360"),
        ("not a number", "1 entries are NaN or infinite"),
        ("both infinities", "2 entries are NaN or infinite"),
        ("an empty channel", "blue channel has no valid"),
    ],
)
def test_a_broken_table_is_refused(capsys, tmp_path, felt, kind, said):
    table = tmp_path / "broken.binary"
    broken(kind, table, felt)
    output = tmp_path / "x.npz"
    line = refused(capsys, tmp_path, "fit", table, "--model", "bivariate", "-o", output)
    assert str(table) in line
    assert said in line


def test_a_channel_without_a_sample_in_range_names_the_file(capsys, tmp_path, felt):
    values = read_binary(felt).values
    values[1, np.minimum(*MERL.cosines) > np.cos(np.deg2rad(80))] = -1
    table = tmp_path / "grazing.binary"
    write_binary(table, Table(values))
    call = ["fit", table, "--model", "bivariate", "--max-angle", "75"]
    line = refused(capsys, tmp_path, *call, "-o", tmp_path / "x.npz")
    assert f"{table}: the green channel" in line


@pytest.mark.parametrize("name", ["x.fit", "x", "x.json", "folder"])
def test_a_fit_under_another_name_is_refused(capsys, tmp_path, felt, name):
    (tmp_path / "folder").mkdir()
    line = refused(capsys, tmp_path, "fit", felt, "--model", "bivariate", "-o", tmp_path / name)
    assert ".npz" in line


def test_an_output_that_cannot_be_written_is_told_in_one_line(capsys, tmp_path, felt):
    (tmp_path / "file").write_text("in the way")
    output = tmp_path / "file" / "x.npz"
    line = refused(capsys, tmp_path, "fit", felt, "--model", "bivariate", "-o", output)
    assert str(tmp_path / "file") in line


def test_published_parameters_are_those_of_the_tables_name(capsys, tmp_path, felt):
    text = (
        "felt = Aggregate(Lambertian(albedo = [0.3, 0.2, 0.1]), "
        "LowMicrofacetFit(A = [1, 2, 3], B = 100, C = 1.5, eta = 1.5))\n"
    )
    file, path = tmp_path / "abc.fit", tmp_path / "felt.npz"
    call = ["fit", felt, "--model", "abc-published"]
    file.write_text(text)
    assert run(capsys, *call, "--published", file, "-o", path)[:2] == (0, "")
    fit, record = fits.load(path), fits.load_record(path)
    np.testing.assert_allclose(np.pi * fit.parameters["rho_d"], [0.3, 0.2, 0.1], rtol=1e-6)
    assert (fit.parameters["b"], record["bytes"]) == (100, 36)
    assert {channel.status for channel in record["channels"]} == {"published"}

    output = tmp_path / "other.npz"
    line = refused(capsys, tmp_path, *call, "-o", output)
    assert "needs --published, the path of low_lowmicrofacet_E2.fit" in line
    file.write_text(text.replace("felt", "felts"))
    line = refused(capsys, tmp_path, *call, "--published", file, "-o", output)
    assert f"{file}: has no material 'felt'; did you mean felts" in line
    call[-1] = "bivariate"
    line = refused(capsys, tmp_path, *call, "--published", file, "-o", output)
    assert "--published is not a setting of 'bivariate'" in line


def test_what_is_not_a_fit_is_not_tabulated(capsys, tmp_path, felt):
    output = tmp_path / "x.binary"
    assert str(felt) in refused(capsys, tmp_path, "tabulate", felt, "-o", output)
    absent = tmp_path / "none.npz"
    assert str(absent) in refused(capsys, tmp_path, "tabulate", absent, "-o", output)


def test_a_synthetic_material_is_that_of_its_seed(capsys, tmp_path):
    name = synthetic.materials()[0]
    path = tmp_path / "a.binary"
    assert run(capsys, "material", "--synthetic", name, "--seed", "7", "-o", path)[:2] == (0, "")
    found, expected = read_binary(path), synthetic.load(name, 7)
    assert (found.valid == expected.valid).all()
    np.testing.assert_allclose(
        found.values[found.valid], expected.values[found.valid], rtol=1e-15, atol=0
    )


def test_a_merl_material_is_a_link_to_the_users_file(capsys, tmp_path, felt):
    path = tmp_path / "felt.binary"
    assert run(capsys, "material", "--merl", "felt", "--from", felt.parent, "-o", path)[0] == 0
    assert path.is_symlink()
    assert path.resolve() == felt.resolve()


def test_a_merl_material_does_not_replace_the_users_file(capsys, tmp_path, felt):
    original = tmp_path / "felt.binary"
    original.write_bytes(felt.read_bytes())
    refused(capsys, tmp_path, "material", "--merl", "felt", "--from", tmp_path, "-o", original)
    assert not original.is_symlink()
    assert original.read_bytes() == felt.read_bytes()


@pytest.mark.parametrize("kind", ["--neural", "--merl"])
def test_a_material_without_its_source_is_refused(capsys, tmp_path, kind):
    line = refused(capsys, tmp_path, "material", kind, "chrome", "-o", tmp_path / "c.binary")
    assert "--from" in line


@pytest.mark.parametrize("verb", ["fit", "tabulate", "material"])
def test_help_shows_an_example_and_units(capsys, verb):
    with pytest.raises(SystemExit) as done:
        main([verb, "--help"])
    assert done.value.code == 0
    said = capsys.readouterr().out
    assert f"python -m npfm {verb} " in said
    assert "1/sr" in said


def test_as_a_program(tmp_path):
    """A mistake is one line on the error output, exit code 1, and no traceback."""
    absent, output = f"{tmp_path}/none.binary", f"{tmp_path}/x.npz"
    call = [sys.executable, "-m", "npfm", "fit", absent, "--model", "naive", "-o", output]
    done = subprocess.run(call, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith(f"npfm fit: {absent}: no such file")
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_where_nothing_can_be_cached_a_fit_is_made_and_says_so(tmp_path, felt, nowhere_to_cache):
    """As on a node of a cluster with a read-only home, or none."""
    arguments = ["--model", "g-from-d", "--max-iterations", "1", "-o", "felt.npz"]
    ended = subprocess.run(
        [sys.executable, "-m", "npfm", "fit", felt, *arguments],
        cwd=tmp_path,
        env=nowhere_to_cache,
        capture_output=True,
        text=True,
    )
    assert ended.returncode == 0, ended.stderr
    assert fits.load(tmp_path / "felt.npz").model == "g-from-d"
    warned = [line for line in ended.stderr.splitlines() if "arning" in line]
    assert len(warned) == 1
    assert warned[0].startswith("npfm fit: warning: compiled code cannot be kept")
    assert "NUMBA_CACHE_DIR" in warned[0]
    assert "Traceback" not in ended.stderr
