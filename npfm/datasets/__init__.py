"""Sources of measured tables: `synthetic`, `merl_folder` (key ``merl``) and `neural`.

Each has ``materials(...)``, the sorted names it offers. `synthetic` and `neural` have ``load``,
which gives a table; `merl_folder` has ``path`` and ``download``, since its tables are files
already.
"""
