"""The path of models whose channels share parameters; that of the others is in the harness."""

import time

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.fitting.channels import CoupledFit, as_table, fit_coupled, shared_traces
from npfm.fitting.fits import Trace
from npfm.fitting.objective import Objective, channel_samples, evaluate
from npfm.reflectance.table import INVALID, Table


def fit(table, slope=1.0, reciprocal=True, pause=0.0):
    """Fit rho_c = rho_d_c + tilt cos(theta_h), of a given tilt that the channels share."""

    def fit_together(samples):
        if pause:
            began = time.process_time()
            while time.process_time() - began < pause:
                pass
        assert [s.value.shape[-1] for s in samples] == [
            table.grid.phi_d_bins // (1 + reciprocal)
        ] * 3
        mean = [np.vdot(s.weight, s.value) / s.weight.sum() for s in samples]
        trace = Trace("only", "converged", 1, 0, (0.0, 0.03), (1.0, 0.5))
        parameters = {"rho_d": slope * np.array(mean), "tilt": np.array([0.0])}
        return CoupledFit(parameters, shared_traces([trace]))

    def tabulate(fit):
        tilt = fit.parameters["tilt"][0] * np.cos(fit.grid.theta_h)[:, None, None]
        values = [rho_d + tilt + np.zeros(fit.grid.shape) for rho_d in fit.parameters["rho_d"]]
        return as_table(values, fit.grid)

    return fit_coupled("m", table, Objective(), fit_together, tabulate, ("rho_d",), reciprocal)


@pytest.mark.parametrize("reciprocal", [True, False])
def test_coefficients_are_in_the_unit_of_the_table_and_the_record_is_of_its_channel(
    table, reciprocal
):
    found = fit(table, reciprocal=reciprocal)
    assert found.parameters["tilt"].shape == (1,)
    assert {array.dtype for array in found.parameters.values()} == {np.dtype(np.float32)}
    for channel, record in enumerate(found.records):
        samples = channel_samples(table, channel, Objective())
        constant = np.full(table.grid.shape, found.parameters["rho_d"][channel] / samples.scale)
        assert record.objective == pytest.approx(evaluate(samples, constant) / samples.energy)
        assert 0 < record.objective_floor < record.objective
        assert record.status == "converged"


def test_the_channels_share_the_time(table):
    records = fit(table, pause=0.06).records
    for record in records:
        assert record.traces[0].seconds == (0.0, 0.01)
        assert record.seconds == records[0].seconds >= 0.02


def test_a_degenerate_channel_says_so(table):
    values = table.values.copy()
    values[0] = np.where(table.grid.above_horizon, 0.0, INVALID)
    values[2] = np.where(table.grid.above_horizon, 0.25, INVALID)
    assert [record.status for record in fit(Table(values, table.grid)).records] == [
        "degenerate: every sample is 0",
        "converged",
        "degenerate: all samples are equal",
    ]


@pytest.mark.parametrize("slope", [1e60, 1e-60])
def test_a_coefficient_that_cannot_be_stored_is_refused(table, slope):
    with pytest.raises(NpfmError, match="the red channel needs a coefficient"):
        fit(table, slope)


def test_a_channel_without_samples_is_refused(table):
    values = table.values.copy()
    values[1] = INVALID
    with pytest.raises(NpfmError, match="the green channel has no valid sample"):
        fit(Table(values, table.grid))
