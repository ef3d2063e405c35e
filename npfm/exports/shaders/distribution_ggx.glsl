// GGX, Walter et al. 2007, equation 33, in 1/sr.
float npfm_distribution(npfm_Angles at) {
  float alpha = npfm_row(npfm_alpha).x;
  float spread = alpha * at.cos_h * at.cos_h + at.sin_h * at.sin_h / alpha;
  return 1.0 / (2.0 * npfm_half_pi * spread * spread);
}

// Cosine over G1 of equation 34 there.
float npfm_area(float cosine) {
  float alpha = npfm_row(npfm_alpha).x;
  return (cosine + sqrt(cosine * cosine + alpha * alpha * (1.0 - cosine * cosine))) / 2.0;
}
