"""Ways of choosing light directions."""
