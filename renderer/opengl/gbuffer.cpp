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

Result<unsigned> compile(bool textured) {
  const std::string version = textured ? gbuffer_shaders::version_textured : gbuffer_shaders::version;
  const std::string vertex = version + gbuffer_shaders::vertex, geometry = version + gbuffer_shaders::geometry,
                    fragment = version + gbuffer_shaders::fragment;
  return compile_program("the G-buffer", {vertex.c_str(), geometry.c_str(), fragment.c_str()});
}

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
    glDeleteTextures(static_cast<GLsizei>(textures.size()), textures.data());
  }

  EglContext& context;
  GLuint program = 0, vertex_array = 0, vertices = 0;
  /// First vertex of each material's triangles in the buffer, and the end.
  std::vector<GLint> begin;
  std::vector<Material> materials;
  std::vector<GLuint> textures;  ///< as the mesh's; empty when no material has one
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();

  Status upload(const Mesh& mesh);
  Status upload_textures(const Mesh& mesh);
  Result<GBuffer> draw(const View& view, int width_px, int height_px) const;
  void draw_materials() const;
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
  static_assert(sizeof(Vertex) == 8 * sizeof(float) && offsetof(Vertex, normal) == 3 * sizeof(float) &&
                offsetof(Vertex, uv) == 6 * sizeof(float));
  for (GLuint i = 0; i < 3; ++i) {
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(i, i < 2 ? 3 : 2, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                          reinterpret_cast<const void*>(i * 3 * sizeof(float)));
  }
  return gl_status("mesh upload");
}

Status GBufferPass::Impl::upload_textures(const Mesh& mesh) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  textures.resize(mesh.textures.size());
  glGenTextures(static_cast<GLsizei>(textures.size()), textures.data());
  for (std::size_t k = 0; k < textures.size(); ++k) {
    const Texture& t = mesh.textures[k];
    if (t.width_px > limit || t.height_px > limit)
      return fail("a texture of " + std::to_string(t.width_px) + "x" + std::to_string(t.height_px) + " pixels",
                  "OpenGL", "give at most " + std::to_string(limit) + " pixels a side");
    glBindTexture(GL_TEXTURE_2D, textures[k]);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB32F, t.width_px, t.height_px, 0, GL_RGB, GL_FLOAT, t.rgb.data());
    glGenerateMipmap(GL_TEXTURE_2D);
  }
  return gl_status("texture upload");
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
  const Result<unsigned> program = compile(!mesh.textures.empty());
  if (!program) return tl::unexpected(program.error());
  impl->program = *program;
  impl->materials = mesh.materials;
  if (const Status uploaded = impl->upload(mesh); !uploaded) return tl::unexpected(uploaded.error());
  if (const Status uploaded = impl->upload_textures(mesh); !uploaded) return tl::unexpected(uploaded.error());
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

  return impl_->draw(*view, width_px, height_px);
}

Result<GBuffer> GBufferPass::Impl::draw(const View& view, int width_px, int height_px) const {
  GBuffer gbuffer{width_px, height_px, {}, {}, {}, {}};
  std::vector<std::vector<float>*> images = {&gbuffer.position, &gbuffer.normal, &gbuffer.face};
  if (!textures.empty()) images.push_back(&gbuffer.reflectance);

  // Draw.
  const std::vector<unsigned> formats(images.size(), GL_RGBA32F);
  const auto target = RenderTarget::create("the G-buffer", width_px, height_px, formats, true);
  if (!target) return tl::unexpected(target.error());
  glViewport(0, 0, width_px, height_px);
  constexpr std::array<float, 4> nothing{}, farthest = {1};
  for (std::size_t k = 0; k < images.size(); ++k) glClearBufferfv(GL_COLOR, static_cast<GLint>(k), nothing.data());
  glClearBufferfv(GL_DEPTH, 0, farthest.data());
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glUseProgram(program);
  glBindVertexArray(vertex_array);
  set_uniforms(view, width_px, height_px);
  draw_materials();

  // Read back.
  for (std::size_t k = 0; k < images.size(); ++k) {
    images[k]->resize(4 * static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
    glReadBuffer(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(k));
    glReadPixels(0, 0, width_px, height_px, GL_RGBA, GL_FLOAT, images[k]->data());
  }
  if (const Status drawn = gl_status("G-buffer"); !drawn) return tl::unexpected(drawn.error());
  return gbuffer;
}

/// Each material's triangles.
void GBufferPass::Impl::draw_materials() const {
  glActiveTexture(GL_TEXTURE0);
  for (std::size_t m = 0; m < materials.size(); ++m) {
    glUniform1f(uniform("material"), static_cast<float>(m));
    if (!textures.empty()) {
      glUniform3fv(uniform("diffuse"), 1, materials[m].diffuse.data());
      glUniform1i(uniform("textured"), materials[m].texture ? 1 : 0);
      glBindTexture(GL_TEXTURE_2D, textures[materials[m].texture.value_or(0)]);
    }
    glDrawArrays(GL_TRIANGLES, begin[m], begin[m + 1] - begin[m]);
  }
}

}  // namespace lumifield
