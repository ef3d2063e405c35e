vec3 npfm_fresnel(npfm_Angles at) {
  return npfm_row(npfm_F + at.d);
}
