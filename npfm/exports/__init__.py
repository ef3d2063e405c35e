"""Fits in the formats of other programs; a file of this folder that declares a NAME is a format.

Beside the NAME it declares what `npfm.exports.registry.Format` says: ABOUT and SUFFIX, and MODELS,
TABLES, MANY, GRIDS, SETTINGS and PARTS where they are not the usual ones. It has

``KIND``
    The `npfm.storage.files.Kind` of what is written: how an older one is told from files of others.
``write(path, sources, **settings) -> str | None``
    Writes what `npfm.exports.sources.Source` say, which were checked against the declarations and
    could be tabulated, through `npfm.storage.files.replacing`. What there is to say of it, in a
    line, is returned. Raises an `NpfmError` if something cannot be said in the format.
"""
