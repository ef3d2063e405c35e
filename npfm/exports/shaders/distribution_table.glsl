// Microfacets that face a half vector, in 1/sr, by its bin.
float npfm_distribution(npfm_Angles at) {
  return npfm_row(npfm_D + at.h).x;
}

// The area of the visible ones, projected along a direction, between nodes of its elevation.
float npfm_area(float cosine) {
  float place = npfm_acos(min(cosine, 1.0)) / npfm_half_pi * float(npfm_sigma_nodes - 1);
  int node = clamp(int(place), 0, npfm_sigma_nodes - 2);
  vec2 ends = vec2(npfm_row(npfm_sigma + node).x, npfm_row(npfm_sigma + node + 1).x);
  return mix(ends.x, ends.y, place - float(node));
}
