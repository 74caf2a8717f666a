#pragma once

namespace lumifield::gbuffer_shaders {

/// Each comes after `version`, or after `version_textured` where a material has a texture.
constexpr const char* version = "#version 430 core\n#define TEXTURED 0\n";
constexpr const char* version_textured = "#version 430 core\n#define TEXTURED 1\n";

/// Clip space has +y down, so that framebuffer row 0 is the picture's top row. The far plane is at infinity.
constexpr const char* vertex = R"GLSL(
uniform dvec3 eye, right, up, forward;  // right and up divided by the tangents of the half angles of view
const float near_mm = 0.1;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
out Corner { vec3 p, n; vec2 t; } corner;
void main() {
  vec3 q = vec3(dvec3(position) - eye);
  float w = dot(vec3(forward), q);
  gl_Position = vec4(dot(vec3(right), q), -dot(vec3(up), q), w - 2.0 * near_mm, w);
  corner.p = position;
  corner.n = normal;
  corner.t = uv;
}
)GLSL";

/// Hands every fragment its whole triangle.
constexpr const char* geometry = R"GLSL(
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
in Corner { vec3 p, n; vec2 t; } corner[];
out Triangle {
  flat vec3 p0, p1, p2, n0, n1, n2;
#if TEXTURED
  flat vec2 t0, t1, t2;
#endif
} triangle;
void main() {
  for (int i = 0; i < 3; ++i) {
    triangle.p0 = corner[0].p;
    triangle.p1 = corner[1].p;
    triangle.p2 = corner[2].p;
    triangle.n0 = corner[0].n;
    triangle.n1 = corner[1].n;
    triangle.n2 = corner[2].n;
#if TEXTURED
    triangle.t0 = corner[0].t;
    triangle.t1 = corner[1].t;
    triangle.t2 = corner[2].t;
#endif
    gl_Position = gl_in[i].gl_Position;
    EmitVertex();
  }
  EndPrimitive();
}
)GLSL";

constexpr const char* fragment = R"GLSL(
uniform dvec3 eye, forward, right_span, up_span;  // spans: half the picture at distance 1 along forward
uniform dvec2 size;
uniform double far_mm;
uniform float material;
in Triangle {
  flat vec3 p0, p1, p2, n0, n1, n2;
#if TEXTURED
  flat vec2 t0, t1, t2;
#endif
} triangle;
layout(location = 0) out vec4 out_position;
layout(location = 1) out vec4 out_normal;
layout(location = 2) out vec4 out_face;
#if TEXTURED
uniform vec3 diffuse;
uniform bool textured;
uniform sampler2D picture;  // first scanline on top: v is turned
layout(location = 3) out vec4 out_reflectance;

vec2 uv(dvec3 b) {
  dvec2 t = b.x * dvec2(triangle.t0) + b.y * dvec2(triangle.t1) + b.z * dvec2(triangle.t2);
  return vec2(t.x, 1.0LF - t.y);
}
#endif
void main() {
  // Intersect the ray with the triangle's plane, relative to the eye.
  dvec2 at = 2.0LF * dvec2(gl_FragCoord.xy) / size - 1.0LF;
  dvec3 d = forward + at.x * right_span - at.y * up_span;
  dvec3 a = dvec3(triangle.p0) - eye;
  dvec3 e1 = dvec3(triangle.p1) - dvec3(triangle.p0);
  dvec3 e2 = dvec3(triangle.p2) - dvec3(triangle.p0);
  dvec3 g = cross(e1, e2);
  double across = dot(d, g), area2 = dot(g, g);
  if (across == 0.0LF || area2 == 0.0LF) discard;
  dvec3 w = dot(a, g) / across * d - a;

  // Keep it on the triangle.
  double b1 = dot(cross(w, e2), g) / area2, b2 = dot(cross(e1, w), g) / area2;
  dvec3 on_plane = dvec3(1.0LF - b1 - b2, b1, b2);
  dvec3 b = max(on_plane, dvec3(0.0LF));
  b /= b.x + b.y + b.z;
  dvec3 q = a + b.y * e1 + b.z * e2;

  // Turn the normal to the side that faces the eye.
  dvec3 face = across < 0.0LF ? g : -g;
  dvec3 n = b.x * dvec3(triangle.n0) + b.y * dvec3(triangle.n1) + b.z * dvec3(triangle.n2);
  if (dot(n, n) == 0.0LF) n = face;
  if (dot(n, face) < 0.0LF) n = -n;

  out_position = vec4(vec3(eye + q), 1.0);
  out_normal = vec4(vec3(normalize(n)), material);
  out_face = vec4(vec3(face * inversesqrt(area2)), 0.0);
#if TEXTURED
  // Neighbours beyond the triangle's edge tell the texture's scale on its plane.
  vec2 free = uv(on_plane);
  vec3 texel = textured ? textureGrad(picture, uv(b), dFdx(free), dFdy(free)).rgb : vec3(1.0);
  out_reflectance = vec4(diffuse * texel, 0.0);
#endif
  gl_FragDepth = float(dot(forward, q) / far_mm);
}
)GLSL";

}  // namespace lumifield::gbuffer_shaders
