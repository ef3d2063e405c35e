"""Numbers printed in Peng et al. 2017, to stand beside ours."""

SOURCE = "Peng et al. 2017"

#: Values of a fit, and how many more they are than those of independent-g (section 2.1).
PARAMETERS, MORE_THAN_INDEPENDENT_G = 822, 6
#: Materials, of 100, whose mean PSNR over the two scenes is above that of independent-g (sec. 3.1).
BETTER_THAN_INDEPENDENT_G, MATERIALS = 88, 100
#: The two scenes: a sphere in Grace, and the Buddha in the Grove, beside which is a sphere here.
SCENES = ("A", "C")
#: A material that it shows to be much better, and two that hardly are (section 3.1).
MUCH_BETTER = "silver-metallic-paint"
HARDLY_BETTER = ("violet-acrylic", "nylon")
#: Materials whose factors it shows (Figure 5).
FACTORS = ("aluminium", "violet-acrylic", "polyurethane-foam")
#: Mean PSNR in dB of the pictures of the UTIA database's materials, by a peak that is not told; how
#: many of its 150 materials are below 100 dB; and values of a fit (sections 2.2 and 3.2).
RENDERING_DB, FEW_DB, BELOW, UTIA_MATERIALS = 106.80, 100, 8, 150
ANISOTROPIC_PARAMETERS = 2010
