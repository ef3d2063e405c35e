vec3 npfm_fresnel(npfm_Angles at) {
  float f0 = npfm_row(npfm_f0).x;
  return vec3(f0 + (1.0 - f0) * pow(1.0 - at.cos_d, 5.0));
}
