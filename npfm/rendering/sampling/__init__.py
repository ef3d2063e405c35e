"""Ways of choosing light directions: one file a strategy, and how several are combined."""
