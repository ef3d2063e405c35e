const float npfm_half_pi = 1.5707963267948966;

// What models are functions of: bins of half and difference angle in the table, sine and cosines of
// these angles, and cosines of normal and light, normal and view.
struct npfm_Angles {
  int h;
  int d;
  float sin_h;
  float cos_h;
  float cos_d;
  float cos_i;
  float cos_o;
};

// Angle in [0, pi/2] of a cosine, to 1e-7: Abramowitz and Stegun, 4.4.46. A built-in acos may be far
// worse.
float npfm_acos(float x) {
  float sum = -0.0012624911;
  sum = sum * x + 0.0066700901;
  sum = sum * x - 0.0170881256;
  sum = sum * x + 0.0308918810;
  sum = sum * x - 0.0501743046;
  sum = sum * x + 0.0889789874;
  sum = sum * x - 0.2145988016;
  sum = sum * x + 1.5707963050;
  return sqrt(max(1.0 - x, 0.0)) * sum;
}

// Of both: the cosine alone has no digits for the angles of a narrow highlight.
float npfm_angle(float sine, float cosine) {
  return sine < cosine ? npfm_half_pi - npfm_acos(sine) : npfm_acos(max(cosine, 0.0));
}

int npfm_bin(float share, int bins) {
  return clamp(int(share * float(bins)), 0, bins - 1);
}

npfm_Angles npfm_angles(vec3 light, vec3 view, vec3 normal) {
  vec3 sum = light + view;
  float size = length(sum);
  npfm_Angles at;
  at.cos_i = dot(light, normal);
  at.cos_o = dot(view, normal);
  at.sin_h = length(cross(normal, sum)) / size;
  at.cos_h = dot(normal, sum) / size;
  at.cos_d = size / 2.0;
  float theta_h = npfm_angle(at.sin_h, at.cos_h);
  float theta_d = npfm_angle(length(light - view) / 2.0, at.cos_d);
  at.h = npfm_bin(sqrt(max(theta_h, 0.0) / npfm_half_pi), npfm_theta_h_bins);
  at.d = npfm_bin(theta_d / npfm_half_pi, npfm_theta_d_bins);
  return at;
}
