"""Numbers printed in Dupuy et al. 2015, to stand beside ours."""

SOURCE = "Dupuy et al. 2015"

#: Largest relative error in backscattering of Beckmann surfaces, by roughness (Table 1).
BACKSCATTER_ERROR = {0.01: 0.03, 0.02: 0.004, 0.05: 0.002, 0.15: 0.0005}
#: Backscattering samples of that table, and of the fits of MERL's materials (section 5.3).
TABLE_1_NODES, MERL_NODES = 360, 90
#: Seconds that a fit of an isotropic material takes at most, on a 2.4 GHz Core i5 (section 5.4).
SECONDS = 1.0
#: And that a fit of an anisotropic material takes (section 5.4).
ANISOTROPIC_SECONDS = 20.0
#: Bytes of a fit of one (section 5.3: 6 KB; 3 N_theta (1 + N_phi) numbers of section 5.1 are 98).
ANISOTROPIC_BYTES = 6144
#: A material of the UTIA database whose albedo depends on direction, which is lost (section 5.3).
DIRECTIONAL_ALBEDO = "fabric106"
#: Materials on which the fits of the shifted-gamma model failed (section 5.3).
SHIFTED_GAMMA_FAILS = ("two-layer-gold", "color-changing-paint1")
#: One that this method fits worse than the two it is compared with (Figure 6).
WORSE = "alumina-oxide"
#: Metals among the materials of MERL, by their names; the paper says "metallic materials".
METALS = (
    "alum-bronze", "aluminium", "black-oxidized-steel", "brass", "chrome", "chrome-steel",
    "grease-covered-steel", "hematite", "nickel", "ss440", "steel", "tungsten-carbide",
    "two-layer-gold", "two-layer-silver",
)  # fmt: skip
