#include "renderer/opengl/gbuffer.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <epoxy/gl.h>
#include <numbers>
#include <string>
#include <utility>

#include "renderer/opengl/gbuffer_shaders.h"
#include "renderer/opengl/gl_objects.h"

namespace lumifield {
namespace {

/// The eye's frame: axes of unit length, tangents of the half angles of view.
struct View {
  Vec3 eye, right, up, forward;
  double tan_x, tan_y;
};

Result<View> view_of(const SceneCamera& camera, int width_px, int height_px) {
  const Vec3 towards = camera.target_mm - camera.position_mm;
  const Vec3 side = towards.cross(camera.up);
  if (!camera.position_mm.allFinite() || !std::isfinite(side.squaredNorm()) ||
      side.norm() <= 1e-9 * towards.norm() * camera.up.norm())
    return fail("position, target and up give no direction of view", "camera",
                "put the target off the position and let up not point along the view");
  if (!(camera.fov_y_deg > 0 && camera.fov_y_deg < 180))
    return fail("fov_y_deg is " + std::to_string(camera.fov_y_deg), "camera", "give an angle between 0 and 180");
  View view;
  view.eye = camera.position_mm;
  view.forward = towards.normalized();
  view.right = side.normalized();
  view.up = view.right.cross(view.forward);
  view.tan_y = std::tan(camera.fov_y_deg * std::numbers::pi / 360);
  view.tan_x = view.tan_y * width_px / height_px;
  return view;
}

constexpr ShaderTexts shaders = {gbuffer_shaders::vertex, gbuffer_shaders::geometry, gbuffer_shaders::fragment};

}  // namespace

struct GBufferPass::Impl {
  explicit Impl(EglContext& c) : context(c) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (!context.make_current()) return;
    glDeleteProgram(program);
    glDeleteVertexArrays(1, &vertex_array);
    glDeleteBuffers(1, &vertices);
  }

  EglContext& context;
  GLuint program = 0, vertex_array = 0, vertices = 0;
  /// First vertex of each material's triangles in the buffer, and the end.
  std::vector<GLint> begin;
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();

  Status upload(const Mesh& mesh);
  void set_uniforms(const View& view, int width_px, int height_px) const;
  GLint uniform(const char* name) const { return glGetUniformLocation(program, name); }
};

Status GBufferPass::Impl::upload(const Mesh& mesh) {
  // Sort the triangles by material, so that each material is one draw call.
  begin.assign(mesh.materials.size() + 1, 0);
  for (const std::uint32_t m : mesh.material) begin[m + 1] += 3;
  for (std::size_t m = 0; m < mesh.materials.size(); ++m) begin[m + 1] += begin[m];
  std::vector<GLint> next = begin;
  std::vector<Vertex> sorted(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.triangles(); ++i) {
    GLint& at = next[mesh.material[i]];
    for (std::size_t k = 0; k < 3; ++k) sorted[static_cast<std::size_t>(at++)] = mesh.vertices[3 * i + k];
  }

  // Bound the scene, for the depth's scale.
  low.setConstant(INFINITY);
  high.setConstant(-INFINITY);
  for (const Vertex& v : mesh.vertices) {
    const Vec3 p(v.position_mm[0], v.position_mm[1], v.position_mm[2]);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }

  // Hand them to the device.
  glGenVertexArrays(1, &vertex_array);
  glBindVertexArray(vertex_array);
  glGenBuffers(1, &vertices);
  glBindBuffer(GL_ARRAY_BUFFER, vertices);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(sorted.size() * sizeof(Vertex)), sorted.data(), GL_STATIC_DRAW);
  static_assert(sizeof(Vertex) == 6 * sizeof(float) && offsetof(Vertex, normal) == 3 * sizeof(float));
  for (GLuint i = 0; i < 2; ++i) {
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                          reinterpret_cast<const void*>(i * 3 * sizeof(float)));
  }
  return gl_status("mesh upload");
}

void GBufferPass::Impl::set_uniforms(const View& view, int width_px, int height_px) const {
  const auto set = [&](const char* name, const Vec3& v) { glUniform3dv(uniform(name), 1, v.data()); };
  set("eye", view.eye);
  set("forward", view.forward);
  set("right", view.right / view.tan_x);
  set("up", view.up / view.tan_y);
  set("right_span", view.right * view.tan_x);
  set("up_span", view.up * view.tan_y);
  glUniform2d(uniform("size"), width_px, height_px);
  const Vec3 farthest = (view.eye - low).cwiseAbs().cwiseMax((view.eye - high).cwiseAbs());
  glUniform1d(uniform("far_mm"), farthest.norm());
}

GBufferPass::GBufferPass(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GBufferPass::~GBufferPass() = default;

Result<std::unique_ptr<GBufferPass>> GBufferPass::create(EglContext& context, const Mesh& mesh) {
  if (const Status current = context.make_current(); !current) return tl::unexpected(current.error());
  auto impl = std::make_unique<Impl>(context);
  const Result<unsigned> program = compile_program("the G-buffer", shaders);
  if (!program) return tl::unexpected(program.error());
  impl->program = *program;
  if (const Status uploaded = impl->upload(mesh); !uploaded) return tl::unexpected(uploaded.error());
  return std::unique_ptr<GBufferPass>(new GBufferPass(std::move(impl)));
}

Result<GBuffer> GBufferPass::draw(const SceneCamera& camera, int width_px, int height_px) {
  if (const Status current = impl_->context.make_current(); !current) return tl::unexpected(current.error());

  // Check size and camera.
  GLint limit = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
  limit = std::min(limit, max_picture_px);
  if (width_px < 1 || height_px < 1 || width_px > limit || height_px > limit)
    return fail("a picture of " + std::to_string(width_px) + "x" + std::to_string(height_px) + " pixels", "picture",
                "ask for 1 to " + std::to_string(limit) + " pixels a side");
  const Result<View> view = view_of(camera, width_px, height_px);
  if (!view) return tl::unexpected(view.error());

  // Draw each material's triangles.
  constexpr std::array<unsigned, 2> formats = {GL_RGBA32F, GL_RGBA32F};
  const auto target = RenderTarget::create("the G-buffer", width_px, height_px, formats, true);
  if (!target) return tl::unexpected(target.error());
  glViewport(0, 0, width_px, height_px);
  constexpr std::array<float, 4> nothing{}, farthest = {1};
  glClearBufferfv(GL_COLOR, 0, nothing.data());
  glClearBufferfv(GL_COLOR, 1, nothing.data());
  glClearBufferfv(GL_DEPTH, 0, farthest.data());
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glUseProgram(impl_->program);
  glBindVertexArray(impl_->vertex_array);
  impl_->set_uniforms(*view, width_px, height_px);
  for (std::size_t m = 0; m + 1 < impl_->begin.size(); ++m) {
    glUniform1f(impl_->uniform("material"), static_cast<float>(m));
    glDrawArrays(GL_TRIANGLES, impl_->begin[m], impl_->begin[m + 1] - impl_->begin[m]);
  }

  // Read back.
  GBuffer gbuffer{width_px, height_px, {}, {}};
  const std::size_t floats = 4 * static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px);
  gbuffer.position.resize(floats);
  gbuffer.normal.resize(floats);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glReadPixels(0, 0, width_px, height_px, GL_RGBA, GL_FLOAT, gbuffer.position.data());
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glReadPixels(0, 0, width_px, height_px, GL_RGBA, GL_FLOAT, gbuffer.normal.data());
  if (const Status drawn = gl_status("G-buffer"); !drawn) return tl::unexpected(drawn.error());
  return gbuffer;
}

}  // namespace lumifield
