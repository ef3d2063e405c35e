"""A run: its configuration, its variants, the code it rests on, and the plans of its studies."""
