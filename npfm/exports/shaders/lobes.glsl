// rho_d + F(theta_d) times the sum over the lobes of
// rho_s D(theta_h) G(theta_i) G(theta_o) / (cos(theta_i) cos(theta_o)):
// Bagher et al. 2016, equation 3; of several lobes, Peng et al. 2017, equation 3.

// G of a lobe at an angle, between its nodes, which are half a degree from both ends.
vec3 npfm_masking(int lobe, float theta) {
  int first = npfm_G + lobe * npfm_G_nodes;
  float place = theta / npfm_half_pi * float(npfm_G_nodes) - 0.5;
  int node = clamp(int(place), 0, npfm_G_nodes - 2);
  float t = place - float(node);
  vec3 low = npfm_row(first + node), high = npfm_row(first + node + 1);
  if (!npfm_spline) return mix(low, high, t);
  // Catmull-Rom: at the two ends, slopes are the difference to the only neighbour.
  vec3 before = node > 0 ? npfm_row(first + node - 1) : 2.0 * low - high;
  vec3 after = node < npfm_G_nodes - 2 ? npfm_row(first + node + 2) : 2.0 * high - low;
  return low + 0.5 * t * (high - before
    + t * (2.0 * before - 5.0 * low + 4.0 * high - after
    + t * (3.0 * (low - high) + after - before)));
}

// BRDF in 1/sr, of unit vectors away from the surface.
vec3 npfm_brdf(vec3 light, vec3 view, vec3 normal) {
  npfm_Angles at = npfm_angles(light, view, normal);
  if (min(at.cos_i, at.cos_o) <= 0.0) return vec3(0.0);
  // Beyond the last node G and the cosine are those of the node, so that nothing grows without end.
  vec2 cosine = clamp(vec2(at.cos_i, at.cos_o), npfm_least_cosine, npfm_largest_cosine);
  vec2 theta = vec2(npfm_acos(cosine.x), npfm_acos(cosine.y));
  vec3 sum = vec3(0.0);
  for (int lobe = 0; lobe < npfm_lobes; lobe++) {
    vec3 D = npfm_row(npfm_D + lobe * npfm_theta_h_bins + at.h);
    vec3 GG = npfm_masking(lobe, theta.x) * npfm_masking(lobe, theta.y);
    sum += npfm_row(npfm_rho_s + lobe) * D * GG;
  }
  vec3 F = npfm_row(npfm_F + at.d);
  return npfm_row(npfm_rho_d) + F * sum / (cosine.x * cosine.y);
}
