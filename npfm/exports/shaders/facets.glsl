// rho_d + rho_s F(theta_d) D(theta_h) / (4 A), with
// A = sigma(theta_o) cos(theta_i) + sigma(theta_i) cos(theta_o) - cos(theta_i) cos(theta_o):
// microfacets with Smith's correlated shadowing, Dupuy et al. 2015, equations 1 to 3.
// BRDF in 1/sr, of unit vectors away from the surface.
vec3 npfm_brdf(vec3 light, vec3 view, vec3 normal) {
  npfm_Angles at = npfm_angles(light, view, normal);
  if (min(at.cos_i, at.cos_o) <= 0.0) return vec3(0.0);
  float area = npfm_area(at.cos_o) * at.cos_i + npfm_area(at.cos_i) * at.cos_o
    - at.cos_i * at.cos_o;
  vec3 F = npfm_fresnel(at);
  return npfm_row(npfm_rho_d) + npfm_row(npfm_rho_s) * F * npfm_distribution(at) / (4.0 * area);
}
