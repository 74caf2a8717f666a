#pragma once

namespace lumifield::gbuffer_shaders {

/// Clip space has +y down, so that framebuffer row 0 is the picture's top row. The far plane is at infinity.
constexpr const char* vertex = R"GLSL(#version 430 core
uniform dvec3 eye, right, up, forward;  // right and up divided by the tangents of the half angles of view
const float near_mm = 0.1;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
out Corner { vec3 p, n; } corner;
void main() {
  vec3 q = vec3(dvec3(position) - eye);
  float w = dot(vec3(forward), q);
  gl_Position = vec4(dot(vec3(right), q), -dot(vec3(up), q), w - 2.0 * near_mm, w);
  corner.p = position;
  corner.n = normal;
}
)GLSL";

/// Hands every fragment its whole triangle.
constexpr const char* geometry = R"GLSL(#version 430 core
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
in Corner { vec3 p, n; } corner[];
out Triangle { flat vec3 p0, p1, p2, n0, n1, n2; } triangle;
void main() {
  for (int i = 0; i < 3; ++i) {
    triangle.p0 = corner[0].p;
    triangle.p1 = corner[1].p;
    triangle.p2 = corner[2].p;
    triangle.n0 = corner[0].n;
    triangle.n1 = corner[1].n;
    triangle.n2 = corner[2].n;
    gl_Position = gl_in[i].gl_Position;
    EmitVertex();
  }
  EndPrimitive();
}
)GLSL";

constexpr const char* fragment = R"GLSL(#version 430 core
uniform dvec3 eye, forward, right_span, up_span;  // spans: half the picture at distance 1 along forward
uniform dvec2 size;
uniform double far_mm;
uniform float material;
in Triangle { flat vec3 p0, p1, p2, n0, n1, n2; } triangle;
layout(location = 0) out vec4 out_position;
layout(location = 1) out vec4 out_normal;
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
  dvec3 b = max(dvec3(1.0LF - b1 - b2, b1, b2), dvec3(0.0LF));
  b /= b.x + b.y + b.z;
  dvec3 q = a + b.y * e1 + b.z * e2;

  // Turn the normal to the side that faces the eye.
  dvec3 face = across < 0.0LF ? g : -g;
  dvec3 n = b.x * dvec3(triangle.n0) + b.y * dvec3(triangle.n1) + b.z * dvec3(triangle.n2);
  if (dot(n, n) == 0.0LF) n = face;
  if (dot(n, face) < 0.0LF) n = -n;

  out_position = vec4(vec3(eye + q), 1.0);
  out_normal = vec4(vec3(normalize(n)), material);
  gl_FragDepth = float(dot(forward, q) / far_mm);
}
)GLSL";

}  // namespace lumifield::gbuffer_shaders
