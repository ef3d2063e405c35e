"""The figures, one file each: functions from tidy tables to a matplotlib `Figure`."""
