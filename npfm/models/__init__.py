"""Models, one file each: `fit(table, ...) -> Fit`, `tabulate(fit) -> Table`, `parameter_count`."""
