#pragma once

namespace lumifield::shadow_map_shaders {

/// Row 0 of a map is its lowest y. The far plane is at infinity.
constexpr const char* vertex = R"GLSL(#version 430 core
uniform vec3 eye;
uniform vec2 middle, half_width;  // of the tangents
uniform float near_mm;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 n;
layout(location = 2) in vec3 d_low_high;
flat out vec4 plane;
flat out vec2 range;
void main() {
  vec3 q = position - eye;
  gl_Position = vec4((q.xy - middle * q.z) / half_width, q.z - 2.0 * near_mm, q.z);
  plane = vec4(n, d_low_high.x - dot(n, eye));
  range = d_low_high.yz - eye.z;
}
)GLSL";

/// The depth is that of the ray through the texel's centre with the triangle's plane, kept within the triangle's own,
/// since the rasteriser's vertices are snapped to 1/256 texel.
constexpr const char* fragment = R"GLSL(#version 430 core
uniform vec2 low, step_px, origin_px;
flat in vec4 plane;
flat in vec2 range;
layout(location = 0) out float depth;
void main() {
  float across = dot(plane.xyz, vec3(low + (gl_FragCoord.xy - origin_px) * step_px, 1.0));
  depth = across == 0.0 ? range.x : clamp(plane.w / across, range.x, range.y);
}
)GLSL";

}  // namespace lumifield::shadow_map_shaders
