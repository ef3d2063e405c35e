"""What a fit minimises, how it is found, and what is kept of it."""
