#include "renderer/visibility/shadow_map_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <epoxy/gl.h>
#include <optional>
#include <string>
#include <utility>

#include "renderer/opengl/gl_objects.h"
#include "renderer/visibility/shadow_map_shaders.h"
#include "renderer/visibility/shadow_mesh.h"

namespace lumifield {
namespace {

constexpr ShaderTexts shaders = {shadow_map_shaders::vertex, nullptr, shadow_map_shaders::fragment};
constexpr const char* use_fewer = "make smaller maps, or use more tiles per map";

/// Maps stand in columns, as few as can be.
struct Atlas {
  int columns, rows;
};

Result<Atlas> atlas_of(std::size_t maps, int size_px) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &limit);
  if (size_px < 1 || size_px > limit)
    return fail("maps of " + std::to_string(size_px) + " texels a side", "shadow maps",
                "ask for 1 to " + std::to_string(limit));
  const std::size_t texels = static_cast<std::size_t>(size_px) * static_cast<std::size_t>(size_px);
  const std::size_t a_side = static_cast<std::size_t>(limit / size_px);
  if (maps > std::min(max_shadow_texels / texels, a_side * a_side))
    return fail(std::to_string(maps) + " maps of " + std::to_string(size_px) + " texels a side", "shadow maps",
                use_fewer);
  const std::size_t columns = std::max<std::size_t>((maps + a_side - 1) / a_side, 1);
  return Atlas{static_cast<int>(columns), static_cast<int>((maps + columns - 1) / columns)};
}

Status check_views(std::span<const ShadowView> views) {
  for (std::size_t k = 0; k < views.size(); ++k) {
    const ShadowView& v = views[k];
    if (v.eye_mm.allFinite() && v.low.allFinite() && v.high.allFinite() && (v.high - v.low).minCoeff() > 0) continue;
    return fail("has no width or no place", "shadow map " + std::to_string(k), "give finite numbers, low below high");
  }
  return {};
}

}  // namespace

struct ShadowMapPass::Impl {
  Impl(EglContext& c, const Mesh& m) : context(c), mesh(m) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (!context.make_current()) return;
    glDeleteProgram(program);
    glDeleteVertexArrays(1, &vertex_array);
    glDeleteBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
  }

  EglContext& context;
  ShadowMesh mesh;
  GLuint program = 0, vertex_array = 0;
  std::array<GLuint, 2> buffers{};  ///< vertices, corners
  std::optional<Pose> pose;         ///< that the vertices stand in
  GLint near_mm = -1, eye = -1, middle = -1, half_width = -1, low = -1, step_px = -1, origin_px = -1;

  Status upload();
  Status place(const Pose& luminaire_to_scene);
  void draw(const ShadowView& view, int size_px, int x_px, int y_px) const;
};

Status ShadowMapPass::Impl::upload() {
  glGenVertexArrays(1, &vertex_array);
  glBindVertexArray(vertex_array);
  glGenBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
  glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
  static_assert(sizeof(PlacedVertex) == 9 * sizeof(float));
  for (GLuint i = 0; i < 3; ++i) {
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, sizeof(PlacedVertex),
                          reinterpret_cast<const void*>(i * 3 * sizeof(float)));
  }
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.corners.size() * sizeof(std::uint32_t)),
               mesh.corners.data(), GL_STATIC_DRAW);
  for (const auto& [at, name] : {std::pair(&near_mm, "near_mm"),
                                 {&eye, "eye"},
                                 {&middle, "middle"},
                                 {&half_width, "half_width"},
                                 {&low, "low"},
                                 {&step_px, "step_px"},
                                 {&origin_px, "origin_px"}})
    *at = glGetUniformLocation(program, name);
  return gl_status("mesh upload");
}

Status ShadowMapPass::Impl::place(const Pose& luminaire_to_scene) {
  if (pose == luminaire_to_scene) return {};
  const std::vector<PlacedVertex> vertices = placed_vertices(mesh, luminaire_to_scene);
  glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(PlacedVertex)), vertices.data(),
               GL_STATIC_DRAW);
  const Status done = gl_status("mesh upload");
  pose = done ? std::optional(luminaire_to_scene) : std::nullopt;
  return done;
}

void ShadowMapPass::Impl::draw(const ShadowView& view, int size_px, int x_px, int y_px) const {
  const auto set = [](GLint at, const Vec2& v) {
    glUniform2f(at, static_cast<float>(v.x()), static_cast<float>(v.y()));
  };
  glUniform3f(eye, float(view.eye_mm.x()), float(view.eye_mm.y()), float(view.eye_mm.z()));
  glUniform1f(near_mm, static_cast<float>(shadow_near_mm));
  set(middle, (view.low + view.high) / 2);
  set(half_width, (view.high - view.low) / 2);
  set(low, view.low);
  set(step_px, (view.high - view.low) / size_px);
  set(origin_px, Vec2(x_px, y_px));
  glViewport(x_px, y_px, size_px, size_px);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.corners.size()), GL_UNSIGNED_INT, nullptr);
}

ShadowMapPass::ShadowMapPass(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ShadowMapPass::~ShadowMapPass() = default;

Result<std::unique_ptr<ShadowMapPass>> ShadowMapPass::create(EglContext& context, const Mesh& mesh) {
  if (const Status current = context.make_current(); !current) return tl::unexpected(current.error());
  auto impl = std::make_unique<Impl>(context, mesh);
  const Result<unsigned> program = compile_program("the shadow maps", shaders);
  if (!program) return tl::unexpected(program.error());
  impl->program = *program;
  if (const Status uploaded = impl->upload(); !uploaded) return tl::unexpected(uploaded.error());
  return std::unique_ptr<ShadowMapPass>(new ShadowMapPass(std::move(impl)));
}

Result<ShadowMaps> ShadowMapPass::draw(const Pose& pose, std::span<const ShadowView> views, int size_px) {
  if (const Status current = impl_->context.make_current(); !current) return tl::unexpected(current.error());
  if (const Status good = check_views(views); !good) return tl::unexpected(good.error());
  ShadowMaps maps{size_px, {views.begin(), views.end()}, {}};
  const Result<Atlas> atlas = atlas_of(views.size(), size_px);
  if (!atlas) return tl::unexpected(atlas.error());
  if (views.empty()) return maps;
  if (const Status placed = impl_->place(pose); !placed) return tl::unexpected(placed.error());

  // Draw each map's triangles, keeping the least depth.
  constexpr std::array<unsigned, 1> formats = {GL_R32F};
  const int width = atlas->columns * size_px, height = atlas->rows * size_px;
  const auto target = RenderTarget::create("shadow maps", width, height, formats, false);
  if (!target) return tl::unexpected(target.error());
  constexpr std::array<float, 4> nothing = {INFINITY, INFINITY, INFINITY, INFINITY};
  glViewport(0, 0, width, height);
  glClearBufferfv(GL_COLOR, 0, nothing.data());
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendEquation(GL_MIN);
  glUseProgram(impl_->program);
  glBindVertexArray(impl_->vertex_array);
  const auto column = [&](std::size_t k) { return static_cast<int>(k) / atlas->rows * size_px; };
  const auto row = [&](std::size_t k) { return static_cast<int>(k) % atlas->rows * size_px; };
  for (std::size_t k = 0; k < views.size(); ++k) impl_->draw(views[k], size_px, column(k), row(k));

  // Read back column by column, so that each map lies whole.
  maps.depth_mm.resize(views.size() * maps.texels());
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  const auto rows = static_cast<std::size_t>(atlas->rows);
  for (std::size_t k = 0; k < views.size(); k += rows)
    glReadPixels(column(k), 0, size_px, static_cast<int>(std::min(rows, views.size() - k)) * size_px, GL_RED, GL_FLOAT,
                 maps.depth_mm.data() + k * maps.texels());
  if (const Status drawn = gl_status("shadow maps"); !drawn) return tl::unexpected(drawn.error());
  return maps;
}

}  // namespace lumifield
