"""Pictures compared, and the tables of a run."""
