#include "renderer/shift_invariant/spot_textures.h"

#include <array>
#include <epoxy/gl.h>
#include <string>

namespace lumifield {

namespace {

/// Rows of one channel to every `stride`-th float of rows of `row_floats`.
template <class T>
void interleave(const T* from, int width_px, int height_px, std::size_t row_floats, std::size_t stride, float* to) {
  for (int j = 0; j < height_px; ++j, to += row_floats)
    for (std::size_t i = 0; i < static_cast<std::size_t>(width_px); ++i) to[i * stride] = static_cast<float>(*from++);
}

}  // namespace

Result<SpotTextures> SpotTextures::create(const LuminaireGeometry& geometry, SpotLookUp look_up) {
  const Measurement& m = geometry.measurement;
  GLint most_px = 0, most_layers = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most_px);
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most_layers);
  const auto none = [&] {
    return fail(
        "images of " + std::to_string(m.width_px) + "x" + std::to_string(m.height_px) + " pixels have no texture",
        "measurement", "use closed-form, or smaller images");
  };
  if (m.width_px < 1 || m.height_px < 1 || m.width_px > most_px || m.height_px > most_px) return none();
  SpotLayout layout(m.width_px, m.height_px, look_up == SpotLookUp::textured);
  if (layout.width_px > most_px || layout.height_px > most_px) return none();
  if (geometry.sampling.cells() < 1 || geometry.sampling.cells() > most_layers)
    return fail(std::to_string(geometry.sampling.cells()) + " cells have no texture", "sampling",
                "give from 1 to " + std::to_string(most_layers));
  SpotTextures made(geometry, std::move(layout));
  const double bytes = 4.0 * static_cast<double>(made.floats()) * made.layout_.width_px * made.layout_.height_px *
                       geometry.sampling.cells();
  if (bytes > most_bytes)
    return fail("the images of all cells take " + std::to_string(static_cast<int>(bytes / 1e6)) + " MB",
                "shift-invariant", "use closed-form, smaller images or fewer cells");
  if (const Status room = made.make_room(); !room) return tl::unexpected(room.error());
  made.held_.resize(static_cast<std::size_t>(geometry.sampling.cells()));
  return made;
}

Status SpotTextures::make_room() {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
  glTexStorage3D(GL_TEXTURE_2D_ARRAY, 1, floats() == 4 ? GL_RGBA32F : GL_R32F, layout_.width_px, layout_.height_px,
                 geometry_.sampling.cells());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D_ARRAY, filter, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D_ARRAY, wrap, GL_CLAMP_TO_EDGE);
  return gl_status("the cells' images");
}

float* SpotTextures::place(std::vector<float>& layer, std::size_t level, std::size_t channel) const {
  const SpotLayout::Level& at = layout_.levels[level];
  const std::size_t pixel = static_cast<std::size_t>(at.y_px) * static_cast<std::size_t>(layout_.width_px) +
                            static_cast<std::size_t>(at.x_px);
  return layer.data() + pixel * floats() + channel;
}

std::vector<float> SpotTextures::layer_of(const CellImage& image) const {
  const std::size_t row = static_cast<std::size_t>(layout_.width_px) * floats();
  std::vector<float> layer(row * static_cast<std::size_t>(layout_.height_px), 0.0F);
  for (std::size_t c = 0; c < geometry_.channels.size(); ++c) {
    const float* channel = image.channel(static_cast<int>(c));
    interleave(channel, image.width_px, image.height_px, row, floats(), place(layer, 0, c));
    if (layout_.levels.size() == 1) continue;
    const std::vector<ImageLevel> coarse = coarse_levels(channel, image.width_px, image.height_px);
    for (std::size_t k = 0; k < coarse.size(); ++k)
      interleave(coarse[k].value.data(), coarse[k].width_px, coarse[k].height_px, row, floats(),
                 place(layer, k + 1, c));
  }
  return layer;
}

Status SpotTextures::hold(CellIndex cell, const std::shared_ptr<const CellImage>& image) {
  const int flat = geometry_.sampling.flat(cell);
  if (geometry_.sampling.contains(cell) && held_[static_cast<std::size_t>(flat)] == image) return {};
  if (const Status good = check_cell(geometry_, cell, *image); !good) return good;
  auto& held = held_[static_cast<std::size_t>(flat)];
  held.reset();  // until it is there
  const std::vector<float> layer = layer_of(*image);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
  glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, flat, layout_.width_px, layout_.height_px, 1,
                  floats() == 4 ? GL_RGBA : GL_RED, GL_FLOAT, layer.data());
  if (const Status done = gl_status("a cell's image"); !done) return done;
  held = image;
  return {};
}

void SpotTextures::bind(int unit) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
}

}  // namespace lumifield
