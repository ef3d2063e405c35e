"""What the papers claim of anisotropic materials, as `npfm.papers.claims` of isotropic ones."""

from functools import partial

from npfm.papers import dupuy2015, peng2017
from npfm.papers import measures_2015 as m15
from npfm.papers import measures_anisotropic as ma
from npfm.papers.claims import BACKSCATTER, LAYOUT, LIGHTS, Claim, Topic

TOPICS = (
    Topic(
        f"Shared lobes on anisotropic materials ({peng2017.SOURCE})",
        ("fidelity",),
        (
            Claim(
                "average PSNR of the pictures",
                f"{peng2017.RENDERING_DB:.2f} dB, {peng2017.UTIA_MATERIALS} materials",
                ma.rendering_psnr,
                LIGHTS,
            ),
            Claim(
                f"materials below {peng2017.FEW_DB} dB",
                f"{peng2017.BELOW} of {peng2017.UTIA_MATERIALS}",
                ma.few_below,
                LIGHTS,
            ),
            Claim("values of a fit", f"{peng2017.ANISOTROPIC_PARAMETERS}", ma.size, LAYOUT),
        ),
    ),
    Topic(
        f"Power iterations on anisotropic materials ({dupuy2015.SOURCE})",
        ("power_iterations_extraction_time", "power_iterations_side_by_side"),
        (
            Claim(
                f"a fit takes less than {dupuy2015.ANISOTROPIC_SECONDS:g} seconds",
                f"{dupuy2015.ANISOTROPIC_SECONDS:g} s, on another machine",
                partial(m15.fast, most=dupuy2015.ANISOTROPIC_SECONDS),
                "the time is that of the whole fit, its record included, on a busy machine",
            ),
            Claim(
                "a fit takes no more than 6 KB",
                f"{dupuy2015.ANISOTROPIC_BYTES / 1024:g} KB at 90 x 90",
                partial(ma.small, most=dupuy2015.ANISOTROPIC_BYTES),
                "the paper's own count, 3 N_theta (1 + N_phi) numbers, makes 98 KB of 90 x 90",
            ),
            Claim("fits cannot fail", "guaranteed", m15.never_fails, BACKSCATTER),
            Claim(
                f"the albedo of {dupuy2015.DIRECTIONAL_ALBEDO} that depends on direction",
                "not reproduced",
                partial(ma.of_one_material, material=dupuy2015.DIRECTIONAL_ALBEDO),
                BACKSCATTER,
            ),
        ),
    ),
)
