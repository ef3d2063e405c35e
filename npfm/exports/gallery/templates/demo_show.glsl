// The mean of the samples as it is shown: Bagher et al. 2016, section 5.
uniform sampler2D sums;
uniform float count, exposure, gamma, split;
out vec4 color;

void main() {
  vec3 mean = texelFetch(sums, ivec2(gl_FragCoord.xy), 0).rgb / count;
  color = vec4(pow(1.0 - exp2(-exposure * max(mean, 0.0)), vec3(1.0 / gamma)), 1.0);
  if (abs(gl_FragCoord.x - split) < 1.0) color = vec4(vec3(gl_FragCoord.x < split ? 0.0 : 1.0), 1.0);
}
