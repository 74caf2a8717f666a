#pragma once

namespace lumifield::spot_shaders {

/// The passes of shift-invariant. They come after a head of #defines:
///
/// CHANNELS 1 or 3; CELLS of a pass; ADD_ALL, add(…, k) of each of them, so that no index is one of a loop; WEIGHTED 1
/// or 0 (SpotLookUp); LEVELS of a textured look-up; PIECES, and lists BEGINS, ENDS, ORIGINS, C0, C1, C2 of them: the
/// basis, φ(τ) = c0 + v (c1 + v c2), v = τ − origin; SHADOW 0 none, 1 by depth maps, 2 by bits of tiles; TEXELS a side
/// of a depth test; GLOSSY 0 or 1; SRGBE 0 or 1 (SpotSums).

/// One triangle over all receivers.
constexpr const char* vertex = R"GLSL(
void main() { gl_Position = vec4(4.0 * float(gl_VertexID & 1) - 1.0, 4.0 * float(gl_VertexID >> 1) - 1.0, 0.0, 1.0); }
)GLSL";

constexpr const char* types = R"GLSL(
#if CHANNELS == 1
#define COLOUR float
#define OF_IMAGE r
#else
#define COLOUR vec3
#define OF_IMAGE rgb
#endif
uniform int columns;                       // of receivers
uniform vec4 cell[CELLS];                  // u_m, mm; sign: +1 adds, −1 takes away; number
uniform sampler2D positions, normals;      // p, mm, and n, luminaire frame
uniform sampler2DArray images;             // by the cell's number
)GLSL";

/// A receiver, and a cell's light on it but for the share that is seen.
constexpr const char* weighted = R"GLSL(
uniform dvec2 center[CELLS];  // u_m, mm
uniform dvec2 spacing, corner, pixel;
uniform double separation;
uniform ivec2 size;  // of the images, pixels
layout(std430, binding = 0) readonly buffer Receivers { double numbers[]; };

const float begins[PIECES] = float[](BEGINS), ends[PIECES] = float[](ENDS), origins[PIECES] = float[](ORIGINS);
const float c0[PIECES] = float[](C0), c1[PIECES] = float[](C1), c2[PIECES] = float[](C2);

struct Receiver { dvec3 p, n; };

bool receiver(out Receiver r) {
  int at = 6 * (int(gl_FragCoord.y) * columns + int(gl_FragCoord.x));
  if (at >= numbers.length()) return false;
  r.p = dvec3(numbers[at], numbers[at + 1], numbers[at + 2]);
  r.n = dvec3(numbers[at + 3], numbers[at + 4], numbers[at + 5]);
  return r.p.z > 0.0LF && r.n != dvec3(0.0LF);
}

// Pixels first … last − 1 of an axis, whose edges are at ((i − nearest) − fraction)/rate in τ.
struct Axis { int first, last, nearest; double fraction, rate; };

// s(u) − s as seen on S, in the form that does not cancel for this receiver.
double offset(double p, double u, double s, double t, double r) {
  return abs(r) < abs(t) ? (p - s) + r * (u - p) : (u - s) + t * (p - u);
}

Axis axis(double p, double u, double z, double a, double from, double step, int pixels) {
  double t = separation / z, r = (z - separation) / z, rate = r * a / step, half_support = double(ends[PIECES - 1]);
  double sigma = offset(p, u, from, t, r) / step, reach = abs(rate) * half_support;
  if (!(sigma + reach >= -1.0LF && sigma - reach <= double(pixels) + 1.0LF)) return Axis(0, 0, 0, 0.0LF, 1.0LF);
  double nearest = round(clamp(sigma, -2.0LF - reach, double(pixels) + 2.0LF + reach));
  double fraction = offset(p, u, from + nearest * step, t, r) / step;
  int first = int(clamp(floor(sigma - reach) - 1.0LF, 0.0LF, double(pixels)));
  int last = int(clamp(ceil(sigma + reach) + 1.0LF, 0.0LF, double(pixels)));
  // On S the whole support shows one half-open pixel.
  if (rate == 0.0LF) return Axis(first, last, int(nearest), fraction >= 0.0LF ? 0.5LF : -0.5LF, 1e-30LF);
  return Axis(first, last, int(nearest), fraction, rate);
}

// ∫φ over pixel i: midpoint rule with its second-derivative term, exact to degree 3. In double: a bright pixel at the
// end of the support counts with few digits of τ.
float w0(Axis x, int i) {
  double at = double(i - x.nearest) - x.fraction, a = at / x.rate, b = (at + 1.0LF) / x.rate;
  double low = min(a, b), high = max(a, b), sum = 0.0LF;
  for (int k = 0; k < PIECES; ++k) {
    double from = max(low, double(begins[k])), to = min(high, double(ends[k]));
    if (from >= to) continue;
    double w = from == low && to == high ? 1.0LF / abs(x.rate) : to - from, v = 0.5LF * (from + to) - double(origins[k]);
    sum += w * (double(c0[k]) + v * (double(c1[k]) + v * double(c2[k])) + double(c2[k]) * (w * w / 12.0LF));
  }
  return float(sum);
}

// Columns at a time, whose weights are kept from row to row.
const int abreast = 8;

COLOUR average(Axis x, Axis y, int number) {
  COLOUR sum = COLOUR(0.0);
  for (int first = x.first; first < x.last; first += abreast) {
    float weight[abreast];
    for (int i = 0; i < abreast; ++i) weight[i] = first + i < x.last ? w0(x, first + i) : 0.0;
    for (int j = y.first; j < y.last; ++j) {
      COLOUR row = COLOUR(0.0);
      for (int i = 0; i < abreast; ++i)
        row += weight[i] * texelFetch(images, ivec3(min(first + i, size.x - 1), j, number), 0).OF_IMAGE;
      sum += w0(y, j) * row;
    }
  }
  return sum;
}

float facing(Receiver r, int k) { return float(dot(r.n, dvec3(center[k] - r.p.xy, -r.p.z))); }
float facing_eye(Receiver r, vec3 eye) { return float(dot(r.n, dvec3(eye))); }
vec3 towards_light(Receiver r, int k) { return vec3(dvec3(center[k] - r.p.xy, -r.p.z)); }

COLOUR light(Receiver r, int k) {
  double near = separation / r.p.z, k_m = dot(r.n, dvec3(center[k] - r.p.xy, -r.p.z));
  COLOUR e = average(axis(r.p.x, center[k].x, r.p.z, spacing.x, corner.x, pixel.x, size.x),
                     axis(r.p.y, center[k].y, r.p.z, spacing.y, corner.y, pixel.y, size.y), int(cell[k].w));
  double factor = near * near * (spacing.x * spacing.y) / r.p.z * k_m;
#if CHANNELS == 1
  return float(factor * double(e));
#else
  return vec3(factor * dvec3(e));
#endif
}
)GLSL";

constexpr const char* textured = R"GLSL(
uniform float separation, area;   // δ; a_x a_y
uniform vec2 corner, per_pixel;   // of the images on S, mm; 1/pixel
uniform vec2 width;               // of the basis, pixels of S for r = 1: a look-up's at level 0 is 1
uniform vec4 level_places[LEVELS];  // in a layer: the level's first pixel, its size
uniform vec2 per_layer;           // 1/its size

// A level as the receiver sees it: where u = 0 is in a layer, how that moves with u, and what it is kept to: the level
// and the texel of 0 around it.
struct Level { vec2 base, step, low, high; };
struct Receiver {
  vec3 p, n;
  Level fine, coarse;
  float part, factor;  // of the coarse one
};

Level level(int number, vec2 base, vec2 step) {
  vec4 place = level_places[number];
  float scale = exp2(-float(number));
  return Level((base * scale + place.xy) * per_layer, step * scale * per_layer, (place.xy - 0.5) * per_layer,
               (place.xy + place.zw + 0.5) * per_layer);
}

bool receiver(out Receiver r) {
  ivec2 at = ivec2(gl_FragCoord.xy);
  r.p = texelFetch(positions, at, 0).xyz;
  r.n = texelFetch(normals, at, 0).xyz;
  bool lit = r.p.z > 0.0 && r.n != vec3(0.0);
  r.p.z = max(r.p.z, 1e-9);
  float per_z = 1.0 / r.p.z, away = (r.p.z - separation) * per_z, near = separation * per_z;
  float number = clamp(log2(abs(away) * max(width.x, width.y)), 0.0, float(LEVELS - 1));
  vec2 base = (r.p.xy * near - corner) * per_pixel, step = away * per_pixel;
  int fine = int(number);
  r.fine = level(fine, base, step);
  r.coarse = level(min(fine + 1, LEVELS - 1), base, step);
  r.part = number - float(fine);
  r.factor = lit ? near * near * area * per_z : 0.0;
  return lit;
}

float facing(Receiver r, int k) { return dot(r.n, vec3(cell[k].xy - r.p.xy, -r.p.z)); }
float facing_eye(Receiver r, vec3 eye) { return dot(r.n, eye); }
vec3 towards_light(Receiver r, int k) { return vec3(cell[k].xy - r.p.xy, -r.p.z); }

COLOUR look_up(Level l, int k) {
  return textureLod(images, vec3(clamp(l.base + cell[k].xy * l.step, l.low, l.high), cell[k].w), 0.0).OF_IMAGE;
}
COLOUR light(Receiver r, int k) {
  return r.factor * max(facing(r, k), 0.0) * mix(look_up(r.fine, k), look_up(r.coarse, k), r.part);
}
)GLSL";

/// What is seen of a cell: depth tests as renderer/visibility/tile_visibility.cl has them, of a patch of texels, or the
/// mean of its tiles' bits.
constexpr const char* shadow = R"GLSL(
#if SHADOW == 1
uniform sampler2D faces;
uniform sampler2DArray depths;
uniform vec4 map[CELLS];       // low corner of the map; texels per unit of x/z, y/z
uniform vec3 map_step[CELLS];  // unit per texel; what is kept of a depth for the bias

// 1 where a surface at the texels' depths hides the receiver; across: its face's normal times the texels' directions, own
// times its own, towards the lamp.
vec4 hidden(vec4 depth, vec4 across, float own, float limit) {
  return vec4(lessThan(depth, vec4(limit))) * vec4(lessThan(depth * across, vec4(own)));
}

float seen(vec3 p, vec3 face, int k) {
  vec2 q = p.xy - cell[k].xy, at = (q / p.z - map[k].xy) * map[k].zw;
  float kept = map_step[k].z, own = dot(face, vec3(q, p.z)) * kept, limit = p.z * kept;
  vec3 towards = own < 0.0 ? -face : face;
  own = abs(own);
  vec2 side = vec2(textureSize(depths, 0).xy);
  bool outside = any(lessThan(at, vec2(0.0))) || any(greaterThan(at, side));
#if TEXELS == 2
  // Bilinear between four.
  vec2 first = floor(at - 0.5), part = at - 0.5 - first, low = map[k].xy + (first + 0.5) * map_step[k].xy;
  float across = dot(towards, vec3(low, 1.0));
  vec2 more = towards.xy * map_step[k].xy;
  vec4 h = hidden(textureGather(depths, vec3((first + 1.0) / side, cell[k].w)),
                  vec4(across + more.y, across + more.y + more.x, across + more.x, across), own, limit);
  vec2 rows = mix(h.wx, h.zy, part.x);
  float sum = mix(rows.x, rows.y, part.y);
#else
  // The coverage of a square of TEXELS − 1 texels a side; of one texel, that.
  const float wide = float(max(TEXELS - 1, 1));
  vec2 first = TEXELS == 1 ? floor(at) : floor(at - 0.5 * wide), part = at - 0.5 * wide - first;
  float sum = 0.0;
  for (int j = 0; j < TEXELS; ++j)
    for (int i = 0; i < TEXELS; ++i) {
      vec2 texel = first + vec2(i, j);
      float depth = texelFetch(depths, ivec3(clamp(texel, vec2(0.0), side - 1.0), cell[k].w), 0).r;
      vec2 w = vec2(1.0);
      if (TEXELS > 1) {
        if (i == 0) w.x = 1.0 - part.x;
        if (i == TEXELS - 1) w.x = part.x;
        if (j == 0) w.y = 1.0 - part.y;
        if (j == TEXELS - 1) w.y = part.y;
      }
      float across = dot(towards, vec3(map[k].xy + (texel + 0.5) * map_step[k].xy, 1.0));
      sum += w.x * w.y * hidden(vec4(depth), vec4(across), own, limit).x;
    }
  sum /= wide * wide;
#endif
  return outside ? 1.0 : 1.0 - sum;
}
float share(vec3 p, vec3 face, int k) { return seen(p, face, k); }
#elif SHADOW == 2
layout(std430, binding = 1) readonly buffer Bits { uint words[]; };
uniform int row_words, receiver_words, per_support;
uniform ivec2 tile[CELLS];  // first column and row
float share(vec3 p, vec3 face, int k) {
  int first = (int(gl_FragCoord.y) * columns + int(gl_FragCoord.x)) * receiver_words, sum = 0;
  for (int j = 0; j < per_support; ++j)
    for (int i = 0; i < per_support; ++i) {
      int column = tile[k].x + i;
      sum += int(words[first + (tile[k].y + j) * row_words + column / 32] >> (column % 32) & 1u);
    }
  return float(sum) / float(per_support * per_support);
}
#else
float share(vec3 p, vec3 face, int k) { return 1.0; }
#endif
)GLSL";

/// renderer/methods/gloss.clh, by colour.
constexpr const char* gloss = R"GLSL(
#if GLOSSY
uniform sampler2D lobe_eyes, lobe_colours;  // towards the eye, shape; colour, kind

vec3 glossy(vec4 eye, vec4 colour, vec3 n, float no, vec3 to_light, float facing) {
  float nearer = inversesqrt(dot(to_light, to_light)), ni = facing * nearer, shape = eye.w;
  vec3 i = to_light * nearer, o = eye.xyz;
  if (colour.w == 0.0 || !(ni > 0.0 && no > 0.0)) return vec3(0.0);
  if (colour.w == 1.0) {
    vec3 d = i - (2.0 * no * n - o);
    // cosⁿ by a series where 1 − cos is so small that the logarithm would lose its digits.
    float below = min(0.5 * dot(d, d), 1.0);
    float logarithm = below < 1e-2 ? -below * (1.0 + below * (0.5 + below * (1.0 / 3.0 + below * 0.25))) : log(1.0 - below);
    return colour.rgb * ((shape + 2.0) * 0.159154943 * exp(shape * logarithm));
  }
  vec3 h = i + o;
  float h2 = max(dot(h, h), 1e-30), scale = inversesqrt(h2), ho = 0.5 * h2 * scale, a2 = shape * shape;
  vec3 c = cross(n, h) * scale;
  float d = a2 + (1.0 - a2) * dot(c, c);
  float shadowing = no * sqrt(a2 + (1.0 - a2) * ni * ni) + ni * sqrt(a2 + (1.0 - a2) * no * no);
  float f = a2 * 0.159154943 / (d * d * max(shadowing, 1e-20)), w = 1.0 - min(ho, 1.0), w2 = w * w;
  return f * (colour.rgb + (1.0 - colour.rgb) * (w2 * w2 * w));
}
#endif
)GLSL";

/// renderer/shift_invariant/srgbe.h
constexpr const char* srgbe = R"GLSL(
#if SRGBE
float power_of_two(int e) { return uintBitsToFloat(uint(127 + e) << 23); }  // from −126 to 127
vec4 srgbe(vec3 c) {
  // Magnitudes are ordered as their bits; NaN is above Inf.
  uvec3 magnitude = floatBitsToUint(c) & 0x7fffffffu;
  uint most = max(magnitude.r, max(magnitude.g, magnitude.b));
  if (most < 0x00800000u) return vec4(128.0, 128.0, 128.0, 0.0) / 255.0;
  if (most >= 0x7f800000u) return vec4(0.0, 0.0, 0.0, 1.0);
  int e = clamp(int(most >> 23) - 125, -126, 129);
  // 2^−e in two steps, as they stand: that of 129 is no normal float.
  precise vec3 m = c * power_of_two(-(e / 2)) * power_of_two(-(e - e / 2));
  return vec4(clamp(floor(255.0 * m + 128.5), 1.0, 255.0), float(e + 126)) / 255.0;
}
vec3 from_srgbe(vec4 texel) {
  vec4 bytes = floor(255.0 * texel + 0.5);
  if (bytes == vec4(0.0, 0.0, 0.0, 255.0)) return vec3(uintBitsToFloat(0x7fc00000u));
  int e = int(bytes.a) - 126;
  precise vec3 c = (bytes.rgb - 128.0) / 255.0 * power_of_two(e / 2) * power_of_two(e - e / 2);
  return c;
}
#endif
)GLSL";

constexpr const char* main = R"GLSL(
layout(location = 0) out vec4 irradiance;
#if GLOSSY
layout(location = 1) out vec4 radiance;
#endif
#if SRGBE
uniform sampler2D irradiance_before, radiance_before;
#endif
COLOUR e = COLOUR(0.0);
vec3 g = vec3(0.0);

void add(Receiver r, vec3 face, vec4 eye, vec4 lobe, float no, int k) {
  COLOUR one = cell[k].z * share(vec3(r.p), face, k) * light(r, k);
  e += one;
#if GLOSSY
  g += glossy(eye, lobe, vec3(r.n), no, towards_light(r, k), facing(r, k)) * one;
#endif
}

void main() {
  Receiver r;
  ivec2 here = ivec2(gl_FragCoord.xy);
  bool lit = receiver(r);
  vec3 face = vec3(0.0);
  vec4 eye = vec4(0.0), lobe = vec4(0.0);
  float no = 0.0;
#if SHADOW == 1
  face = texelFetch(faces, here, 0).xyz;
#endif
#if GLOSSY
  eye = texelFetch(lobe_eyes, here, 0);
  lobe = texelFetch(lobe_colours, here, 0);
  no = facing_eye(r, eye.xyz);
#endif
#if WEIGHTED
  if (lit)
    for (int k = 0; k < CELLS; ++k)
      if (facing(r, k) > 0.0) add(r, face, eye, lobe, no, k);
#else
  ADD_ALL
#endif
#if SRGBE
  irradiance = srgbe(from_srgbe(texelFetch(irradiance_before, here, 0)) + vec3(e));
#if GLOSSY
  radiance = srgbe(from_srgbe(texelFetch(radiance_before, here, 0)) + g);
#endif
#else
  irradiance = vec4(vec3(e), 0.0);
#if GLOSSY
  radiance = vec4(g, 0.0);
#endif
#endif
}
)GLSL";

}  // namespace lumifield::spot_shaders
