"""Sources of measured tables, one module each.

They are `synthetic`, `synthetic_anisotropic`, `analytic` (key ``formula``), `merl_folder` (key
``merl``), `utia_folder` (key ``utia``), `rgl_folder` (key ``rgl``) and `neural`. Each has
``materials(...)``, the sorted names it offers. Those that make tables have ``load``, which gives
one (`analytic`: ``tabulated``); the folders of MERL and UTIA have ``path``, since their tables are
files already.
"""
