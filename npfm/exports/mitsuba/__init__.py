"""Our materials in Mitsuba 3, for any scene of a user's and for light that bounces."""

from npfm.exports.mitsuba.engine import start


def register(variant: str | None = None) -> None:
    """Make the BSDF ``npfm`` known to Mitsuba, in the variant that is set.

    Parameters
    ----------
    variant : str, optional
        To be set before, as in `npfm.exports.mitsuba.engine.start`. After another
        ``mitsuba.set_variant``, register again.

    Raises
    ------
    NpfmError
        If Mitsuba is not installed, or the variant is none of its, or has wavelengths.
    """
    mitsuba = start(variant)
    from npfm.exports.mitsuba import plugin

    mitsuba.register_bsdf(plugin.NAME, plugin.bsdf_type(mitsuba.variant()))
