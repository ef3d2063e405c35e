"""A BSDF of Mitsuba 3 over a table, sampled by one of our strategies."""

from functools import cache
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from npfm.errors import NpfmError
from npfm.exports.mitsuba.reflectance import Reflectance
from npfm.exports.mitsuba.samplers import Sampler, check, twin
from npfm.fitting import fits
from npfm.fitting.sources import table as table_of
from npfm.reflectance.table import Table
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import per_view, registry
from npfm.rendering.sampling.strategy import Given

#: The type by which scenes name it.
NAME = "npfm"
#: Share of directions by the cosine of `normal-distribution`, if a scene says nothing else: the
#: distribution knows nothing of a diffuse part, which other strategies have in them.
COSINE_SHARE = 0.05
#: Strategies are given a light, and these have no use for it.
ANY_LIGHT = Environment(np.ones((1, 2, 3)))


def sampler(
    table: Table, name: str = per_view.NAME, fit: str | None = None, share: float = COSINE_SHARE
) -> Sampler:
    """Make what chooses directions for a material.

    Parameters
    ----------
    table : Table
    name : str
        A strategy, one of those that `npfm.exports.mitsuba.samplers.TWINS` has.
    fit : str, optional
        Path of a fit (``.npz``) of the material, for strategies that need one.
    share : float
        Of directions by the cosine, from 0 to 1, with strategies that leave some light out.

    Raises
    ------
    NpfmError
        If there is no such strategy for Mitsuba, or the fit is needed and missing, or has not what
        the strategy needs.
    """
    check(name)
    parameters = fits.load(fit).parameters if fit else {}
    [strategy] = registry.make([name], Given(ANY_LIGHT, table.grid, table, parameters))
    return twin(name, strategy, share)


def bsdf(table: Table, chosen: Sampler) -> Any:
    """Make a BSDF from a table in memory, to be put into the dictionary of a scene."""
    return bsdf_type(mi.variant())(mi.Properties(NAME), (Reflectance(table), chosen))


@cache
def bsdf_type(variant: str) -> type:
    """Return the class of the BSDF for a variant, which has to be set."""

    class TableBSDF(mi.BSDF):
        """A measured or fitted material; reflects nothing on the back.

        Parameters in a scene: ``filename``, a MERL ``.binary`` or a fit; ``sampling``, a strategy;
        ``fit``, what that follows; ``cosine``, the share of directions by the cosine.
        """

        def __init__(self, properties: Any, made: tuple[Reflectance, Sampler] | None = None):
            mi.BSDF.__init__(self, properties)
            self.reflectance, self.sampler = made or _read(properties)
            self.m_flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            self.m_components = [self.m_flags]

        def sample(
            self, context: Any, si: Any, sample1: Any, sample2: Any, active: Any = True
        ) -> Any:
            light = self.sampler.sample(si.wi, sample1, sample2)
            value, density = self.eval_pdf(context, si, light, active)
            result = mi.BSDFSample3f()
            result.wo, result.pdf, result.eta = light, density, 1.0
            result.sampled_type, result.sampled_component = mi.UInt32(+self.m_flags), 0
            usable = density > 0
            return result, dr.select(usable, value / dr.select(usable, density, 1.0), 0.0)

        def eval(self, context: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(context, si, wo, active)[0]

        def pdf(self, context: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval_pdf(context, si, wo, active)[1]

        def eval_pdf(self, context: Any, si: Any, wo: Any, active: Any = True) -> Any:
            above = active & (si.wi.z > 0) & (wo.z > 0)
            value = self.reflectance.brdf(si.wi, wo) * wo.z
            density = self.sampler.pdf(si.wi, wo)
            return dr.select(above, value, 0.0), dr.select(above, density, 0.0)

        def to_string(self) -> str:
            return f"{NAME}[{type(self.sampler).__name__}]"

    return TableBSDF


def _read(properties: Any) -> tuple[Reflectance, Sampler]:
    """Table and sampler that the properties of a scene name."""
    path = _found(properties["filename"])
    table = table_of(path)
    chosen = str(properties.get("sampling", per_view.NAME))
    fit = _found(properties["fit"]) if "fit" in properties else None
    share = float(properties.get("cosine", COSINE_SHARE))
    if not 0 <= share <= 1:
        raise NpfmError(f"'cosine' of a material is {share:g}; give a share from 0 to 1")
    return Reflectance(table), sampler(table, chosen, fit, share)


def _found(name: Any) -> str:
    """Path of a file that a scene names, beside the scene or where Mitsuba looks for files."""
    return str(mi.file_resolver().resolve(str(name)))
