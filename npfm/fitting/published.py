"""Parameters that others published, as fits: nothing is fitted, but there is a record."""

from dataclasses import replace

from npfm.fitting.channels import records_of, with_end
from npfm.fitting.fits import Fit, Trace
from npfm.fitting.objective import Objective, channel_samples, fold
from npfm.reflectance.table import CHANNELS, Table

STATUS = "published"


def with_record(fit: Fit, made: Table, table: Table, objective: Objective) -> Fit:
    """Return published parameters with a record that says so.

    Parameters
    ----------
    fit : Fit
        The parameters.
    made : Table
        What their model makes of them, reciprocal.
    table, objective
        The measurement, and what is recorded of it: how near the parameters come.

    Raises
    ------
    NpfmError
        If a channel of the table has no sample that counts.
    """
    channels = range(len(CHANNELS))
    folded = [fold(channel_samples(table, channel, objective)) for channel in channels]
    trace = Trace(STATUS, STATUS, 0, 0, (0.0,), (0.0,))
    records = records_of(made, folded, [[trace]] * len(CHANNELS), 0.0)
    return replace(fit, records=tuple(with_end(record) for record in records))
