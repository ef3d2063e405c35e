"""Sources of measured tables: `synthetic`, `directory` (key ``merl``) and `neural`.

Each has ``materials(...)``, the sorted names it offers. `synthetic` and `neural` have ``load``,
which gives a table; `directory` has ``path`` and ``download``, since its tables are files already.
"""
