#include "renderer/shift_invariant/spot_totals.h"

#include <algorithm>
#include <cmath>
#include <epoxy/gl.h>
#include <string>
#include <utility>

#include "renderer/shift_invariant/spot_program.h"
#include "renderer/shift_invariant/srgbe.h"

namespace lumifield {

Result<SpotTotals> SpotTotals::create(SpotSums sums, bool glossy, int columns, int rows) {
  SpotTotals made;
  made.sums_ = sums;
  made.images_ = glossy ? 2 : 1;
  if (const Status done = made.make(columns, rows); !done) return tl::unexpected(done.error());
  if (const Status done = made.clear(); !done) return tl::unexpected(done.error());
  return made;
}

SpotTotals::SpotTotals(SpotTotals&& other) noexcept { *this = std::move(other); }
SpotTotals& SpotTotals::operator=(SpotTotals&& other) noexcept {
  sums_ = other.sums_;
  columns_ = other.columns_;
  rows_ = other.rows_;
  images_ = other.images_;
  std::swap(framebuffer_, other.framebuffer_);
  std::swap(textures_, other.textures_);
  return *this;
}
SpotTotals::~SpotTotals() {
  if (framebuffer_ != 0) glDeleteFramebuffers(1, &framebuffer_);
}

Status SpotTotals::make(int columns, int rows) {
  columns_ = columns;
  rows_ = rows;
  const bool coded = sums_ == SpotSums::srgbe;
  for (std::size_t k = 0; k < (coded ? 2 : 1) * images_; ++k) {
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, textures_[k].id());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexStorage2D(GL_TEXTURE_2D, 1, coded ? GL_RGBA8 : GL_RGBA32F, columns, rows);
  }
  glGenFramebuffers(1, &framebuffer_);
  return gl_status("sums of irradiance");
}

/// The pair that is drawn to next.
void SpotTotals::bind_to_draw() const {
  constexpr std::array<GLenum, 2> colours = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glDrawBuffers(static_cast<GLsizei>(images_), colours.data());
  glViewport(0, 0, columns_, rows_);
}

namespace {

void attach(std::size_t number, GlTexture& texture) {
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(number), GL_TEXTURE_2D,
                         texture.id(), 0);
}

}  // namespace

Status SpotTotals::clear() {
  bind_to_draw();
  for (std::size_t k = 0; k < images_; ++k) attach(k, textures_[k]);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return fail("no framebuffer for sums of irradiance", "OpenGL", "use a smaller picture or another driver");
  const float offset = sums_ == SpotSums::srgbe ? 128.0F / 255.0F : 0;
  const std::array<float, 4> zero = {offset, offset, offset, 0};
  glDisable(GL_SCISSOR_TEST);
  for (std::size_t k = 0; k < images_; ++k) glClearBufferfv(GL_COLOR, static_cast<GLint>(k), zero.data());
  return gl_status("sums of irradiance");
}

void SpotTotals::begin_pass() {
  bind_to_draw();
  glDisable(GL_DEPTH_TEST);
  if (sums_ == SpotSums::float32) {
    for (std::size_t k = 0; k < images_; ++k) attach(k, textures_[k]);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ONE);
    return;
  }
  glDisable(GL_BLEND);
  for (std::size_t k = 0; k < images_; ++k) {
    std::swap(textures_[k], textures_[images_ + k]);
    attach(k, textures_[k]);
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(SpotUnits::irradiance_before) + static_cast<GLenum>(k));
    glBindTexture(GL_TEXTURE_2D, textures_[images_ + k].id());
  }
}

Status SpotTotals::read(bool radiance, std::vector<float>& rgb) {
  const std::size_t image = radiance ? 1 : 0;
  const std::size_t texels = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  rgb.resize(3 * texels);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  attach(image, textures_[image]);
  glReadBuffer(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(image));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  if (sums_ == SpotSums::float32) {
    glReadPixels(0, 0, columns_, rows_, GL_RGB, GL_FLOAT, rgb.data());
    return gl_status("sums of irradiance");
  }
  std::vector<Srgbe> coded(texels);
  glReadPixels(0, 0, columns_, rows_, GL_RGBA, GL_UNSIGNED_BYTE, coded.data());
  for (std::size_t k = 0; k < texels; ++k) {
    const std::array<float, 3> colour = from_srgbe(coded[k]);
    std::copy(colour.begin(), colour.end(), rgb.begin() + static_cast<std::ptrdiff_t>(3 * k));
  }
  return gl_status("sums of irradiance");
}

}  // namespace lumifield
