// A pass: `count` pairs of light directions for every pixel, one as the light is distributed and
// one about half vectors as the microfacets are, combined by the balance heuristic (Veach 1997).
uniform sampler2D previous;  // sums of earlier passes
uniform sampler2D light;     // radiance, straight up in row 0, as npfm.rendering.lights.environment
uniform sampler2D down;      // probability and cosine above each row
uniform sampler2D across;    // probability left of each column, in its row
uniform sampler2D facets;    // theta_h bins: probability below, sin^2 at the lower edge, density
uniform sampler2D normals;   // of the figure, if that is what is seen
uniform bool figure;
uniform mat3 turned;         // from the axes of the camera to those of the light
uniform float total;         // luminance of the light, over the sphere
uniform float distant, edge; // the camera: distance, tangent of half its field
uniform vec2 size, offset;   // pixels of the picture; where rays pass through a pixel
uniform uint first, seed;
uniform int count;
out vec4 sum;

const float pi = 3.141592653589793;
const float grazing = 0.02;  // npfm.rendering.surfaces.GRAZING

uint hashed(uint x) {  // O'Neill 2014, PCG: RXS M XS
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
  return (x >> 22u) ^ x;
}

// Point n of a sequence that fills the square evenly (Roberts 2018, R2), from a start of its own.
vec2 point(uint n, uvec2 start) {
  return vec2((start + n * uvec2(3242174889u, 2447445414u)) >> 8u) / 16777216.0;
}

int searched(sampler2D cumulative, int row, int count, float u) {
  int low = 0, high = count;
  while (high - low > 1) {
    int middle = (low + high) / 2;
    if (texelFetch(cumulative, ivec2(middle, row), 0).r <= u) low = middle; else high = middle;
  }
  return low;
}

ivec2 texel_of(vec3 direction) {
  ivec2 shape = textureSize(light, 0);
  float radius = length(direction.xz);
  float theta = npfm_angle(radius, abs(direction.y));
  if (direction.y < 0.0) theta = pi - theta;
  vec2 side = abs(direction.xz) / max(radius, 1e-20);
  float azimuth = npfm_angle(side.x, side.y);
  if (direction.z > 0.0) azimuth = pi - azimuth;
  if (direction.x < 0.0) azimuth = -azimuth;
  int column = int((azimuth + pi) / (2.0 * pi) * float(shape.x));
  return ivec2(column % shape.x, min(int(theta / pi * float(shape.y)), shape.y - 1));
}

// Behind the objects the coarse map is smoothed; they reflect it as it is.
vec3 backdrop(vec3 direction) {
  ivec2 shape = textureSize(light, 0);
  float azimuth = atan(direction.x, -direction.z) + pi;
  vec2 place = vec2(azimuth / (2.0 * pi), acos(clamp(direction.y, -1.0, 1.0)) / pi);
  place = place * vec2(shape) - 0.5;
  ivec2 corner = ivec2(floor(place));
  vec2 part = place - vec2(corner);
  vec3 found = vec3(0.0);
  for (int k = 0; k < 4; k++) {
    ivec2 step = ivec2(k & 1, k >> 1), at = corner + step + ivec2(shape.x, 0);
    vec2 share = mix(1.0 - part, part, vec2(step));
    at = ivec2(at.x % shape.x, clamp(at.y, 0, shape.y - 1));
    found += share.x * share.y * texelFetch(light, at, 0).rgb;
  }
  return found;
}

vec3 light_direction(vec2 u, out vec3 radiance) {
  ivec2 shape = textureSize(light, 0);
  int row = searched(down, 0, shape.y, u.x);
  vec2 above = texelFetch(down, ivec2(row, 0), 0).rg;
  vec2 below = texelFetch(down, ivec2(row + 1, 0), 0).rg;
  float y = mix(above.y, below.y, (u.x - above.x) / (below.x - above.x));
  int column = searched(across, row, shape.x, u.y);
  float left = texelFetch(across, ivec2(column, row), 0).r;
  float right = texelFetch(across, ivec2(column + 1, row), 0).r;
  float azimuth = (float(column) + (u.y - left) / (right - left)) / float(shape.x) * 2.0 * pi - pi;
  float radius = sqrt(max((1.0 - y) * (1.0 + y), 0.0));
  radiance = texelFetch(light, ivec2(column, row), 0).rgb;
  return normalize(vec3(radius * sin(azimuth), y, -radius * cos(azimuth)) * turned);
}

// Axes across a normal, Duff et al. 2017.
mat3 axes(vec3 n) {
  float s = n.z < 0.0 ? -1.0 : 1.0, a = -1.0 / (s + n.z), b = n.x * n.y * a;
  return mat3(1.0 + s * n.x * n.x * a, s * b, -s * n.x, b, s + n.y * n.y * a, -n.y, n);
}

vec3 facet_direction(vec2 u, vec3 view, mat3 frame) {
  int bin = searched(facets, 0, npfm_theta_h_bins, u.x);
  vec2 low = texelFetch(facets, ivec2(bin, 0), 0).rg;
  vec2 high = texelFetch(facets, ivec2(bin + 1, 0), 0).rg;
  float square = mix(low.y, high.y, (u.x - low.x) / (high.x - low.x));
  float sine = sqrt(square), azimuth = 2.0 * pi * u.y;
  vec3 h = frame * vec3(sine * cos(azimuth), sine * sin(azimuth), sqrt(max(1.0 - square, 0.0)));
  return normalize(2.0 * dot(h, view) * h - view);
}

// Light that a direction brings, over the density of both ways to choose it.
vec3 reflected(vec3 to, vec3 radiance, vec3 view, vec3 normal) {
  float cosine = dot(to, normal);
  if (cosine <= 0.0) return vec3(0.0);
  npfm_Angles at = npfm_angles(to, view, normal);
  float density = dot(radiance, vec3(0.2126, 0.7152, 0.0722)) / total
    + texelFetch(facets, ivec2(at.h, 0), 0).b * at.cos_h / (4.0 * at.cos_d);
  return density > 0.0 ? npfm_brdf(to, view, normal) * radiance * (cosine / density) : vec3(0.0);
}

bool met(vec3 ray, out vec3 normal) {
  if (figure) {
    vec4 found = texelFetch(normals, ivec2(gl_FragCoord.xy), 0);
    normal = found.xyz;
    return found.w > 0.0;
  }
  float along = -distant * ray.z, half_chord = 1.0 + along * along - distant * distant;
  normal = vec3(0.0, 0.0, distant) + (along - sqrt(max(half_chord, 0.0))) * ray;
  return half_chord > 0.0;
}

// npfm.rendering.surfaces.towards
vec3 towards(vec3 normal, vec3 view) {
  float cosine = dot(normal, view);
  if (cosine >= grazing) return normal;
  return grazing * view + sqrt(1.0 - grazing * grazing) * normalize(normal - cosine * view);
}

void main() {
  vec4 before = texelFetch(previous, ivec2(gl_FragCoord.xy), 0);
  vec2 place = (floor(gl_FragCoord.xy) + offset) / size;
  vec3 ray = normalize(vec3(edge * (2.0 * place - 1.0), -1.0)), view = -ray, normal;
  if (!met(ray, normal)) {
    sum = before + float(count) * vec4(backdrop(turned * ray), 0.0);
    return;
  }
  normal = towards(normal, view);
  mat3 frame = axes(normal);
  uint pixel = hashed(uint(gl_FragCoord.y) * uint(size.x) + uint(gl_FragCoord.x) + hashed(seed));
  uvec4 starts = uvec4(hashed(pixel), hashed(pixel + 1u), hashed(pixel + 2u), hashed(pixel + 3u));
  vec3 found = vec3(0.0), radiance;
  for (int k = 0; k < count; k++) {
    uint n = first + uint(k);
    vec3 to = light_direction(point(n, starts.xy), radiance);
    found += reflected(to, radiance, view, normal);
    to = facet_direction(point(n, starts.zw), view, frame);
    radiance = texelFetch(light, texel_of(turned * to), 0).rgb;
    found += reflected(to, radiance, view, normal);
  }
  sum = before + vec4(found, float(count));
}
