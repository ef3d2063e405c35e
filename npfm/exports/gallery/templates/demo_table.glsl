// A measured table: the value of the cell that a pair of directions falls into.
uniform highp sampler3D measured;
uniform float scale;

vec3 npfm_brdf(vec3 light, vec3 view, vec3 normal) {
  npfm_Angles at = npfm_angles(light, view, normal);
  if (min(at.cos_i, at.cos_o) <= 0.0) return vec3(0.0);
  float sine = dot(light, cross(normal, view)) / (2.0 * at.cos_d);
  float phi_d = atan(sine, (at.cos_o - at.cos_i) / 2.0);
  int p = npfm_bin(fract(phi_d / (2.0 * npfm_half_pi) + 1.0), npfm_phi_d_bins);
  return scale * texelFetch(measured, ivec3(p, at.d, at.h), 0).rgb;
}
