#include "renderer/shift_invariant/spot_textures.h"

#include <array>
#include <epoxy/gl.h>
#include <string>

#include "renderer/methods/image_levels.h"
#include "renderer/shift_invariant/spot_images.h"

namespace lumifield {

namespace {

/// One channel of a level into every `stride`-th float of rows of `width`.
template <class T>
void interleave(const T* from, int width_px, int height_px, std::size_t width, std::size_t stride, float* to) {
  for (int j = 0; j < height_px; ++j)
    for (int i = 0; i < width_px; ++i)
      to[(static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i)) * stride] = static_cast<float>(*from++);
}

}  // namespace

int SpotTextures::width(int level) const {
  return padded_spot_size(geometry_.measurement.width_px, coarsest_) >> level;
}
int SpotTextures::height(int level) const {
  return padded_spot_size(geometry_.measurement.height_px, coarsest_) >> level;
}

Result<SpotTextures> SpotTextures::create(const LuminaireGeometry& geometry, SpotLookUp look_up) {
  const Measurement& m = geometry.measurement;
  const bool textured = look_up == SpotLookUp::textured;
  GLint most_px = 0, most_layers = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most_px);
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most_layers);
  const auto sized = [](int px) { return px >= 1 && px <= 1 << 24; };
  if (!sized(m.width_px) || !sized(m.height_px) || m.width_px > most_px || m.height_px > most_px)
    return fail(
        "images of " + std::to_string(m.width_px) + "x" + std::to_string(m.height_px) + " pixels have no texture",
        "measurement", "give from 1 to " + std::to_string(most_px) + " pixels a side");
  if (geometry.sampling.cells() < 1 || geometry.sampling.cells() > most_layers)
    return fail(std::to_string(geometry.sampling.cells()) + " cells have no texture", "sampling",
                "give from 1 to " + std::to_string(most_layers));
  SpotTextures made(geometry, textured ? coarsest_spot_level(m.width_px, m.height_px) : 0);
  const double bytes = static_cast<double>(made.texels(0)) * geometry.sampling.cells() * (made.rgb() ? 16 : 4);
  if (bytes > most_bytes)
    return fail("the images of all cells take " + std::to_string(static_cast<int>(bytes / 1e6)) + " MB",
                "shift-invariant", "use closed-form, smaller images or fewer cells");
  if (const Status room = made.make_room(); !room) return tl::unexpected(room.error());
  made.held_.resize(static_cast<std::size_t>(geometry.sampling.cells()));
  return made;
}

Status SpotTextures::make_room() {
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
  glTexStorage3D(GL_TEXTURE_2D_ARRAY, coarsest_ + 1, rgb() ? GL_RGBA32F : GL_R32F, width(0), height(0),
                 geometry_.sampling.cells());
  const bool textured = coarsest_ > 0;
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, textured ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  // Outside the image is 0.
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  constexpr std::array<float, 4> nothing{};
  glTexParameterfv(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BORDER_COLOR, nothing.data());
  return gl_status("the cells' images");
}

Status SpotTextures::hold(CellIndex cell, const std::shared_ptr<const CellImage>& image) {
  const int flat = geometry_.sampling.flat(cell);
  auto& held = held_[static_cast<std::size_t>(flat)];
  if (held == image) return {};
  held.reset();  // until it is there

  // Level by level.
  const std::size_t stride = rgb() ? 4 : 1;
  std::vector<std::vector<ImageLevel>> coarse;
  for (int c = 0; coarsest_ > 0 && c < image->channels; ++c)
    coarse.push_back(coarse_levels(image->channel(c), image->width_px, image->height_px));
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
  for (int level = 0; level <= coarsest_; ++level) {
    std::vector<float> texels = padded(level);
    const auto row = static_cast<std::size_t>(width(level));
    for (std::size_t c = 0; c < geometry_.channels.size(); ++c) {
      if (level == 0)
        interleave(image->channel(static_cast<int>(c)), image->width_px, image->height_px, row, stride,
                   texels.data() + c);
      else if (static_cast<std::size_t>(level) <= coarse[c].size()) {
        const ImageLevel& of = coarse[c][static_cast<std::size_t>(level - 1)];
        interleave(of.value.data(), of.width_px, of.height_px, row, stride, texels.data() + c);
      }
    }
    glTexSubImage3D(GL_TEXTURE_2D_ARRAY, level, 0, 0, flat, width(level), height(level), 1, rgb() ? GL_RGBA : GL_RED,
                    GL_FLOAT, texels.data());
  }
  if (const Status done = gl_status("a cell's image"); !done) return done;
  held = image;
  return {};
}

void SpotTextures::bind(int unit) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
}

}  // namespace lumifield
