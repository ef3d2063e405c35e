"""Products of tabulated factors: the problems that solvers are given, and what they rest on."""
