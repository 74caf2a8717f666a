#include "renderer/shift_invariant/spot_receivers.h"

#include <algorithm>
#include <epoxy/gl.h>
#include <string>

#include "renderer/shift_invariant/spot_program.h"

namespace lumifield {

namespace {

void bind_texture(int unit, GlTexture& texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, texture.id());
}

Status fill_buffer(GlBuffer& buffer, std::span<const std::byte> bytes, const char* what) {
  GLint64 most = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  if (bytes.size() > static_cast<std::size_t>(most))
    return fail(std::string(what) + " take more than " + std::to_string(most / 1000000) + " MB", "receivers",
                "render in parts");
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer.id());
  glBufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(bytes.size()), bytes.data(), GL_STREAM_DRAW);
  return gl_status(what);
}

}  // namespace

Status SpotReceivers::fill(GlTexture& texture, std::span<const float> four_each) {
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  const std::size_t whole = 4 * static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  if (four_each.size() == whole) {
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, columns_, rows_, 0, GL_RGBA, GL_FLOAT, four_each.data());
    return gl_status("receivers");
  }
  // What fills the last row is no receiver.
  std::vector<float> filled(four_each.begin(), four_each.end());
  filled.resize(whole, 0.0F);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, columns_, rows_, 0, GL_RGBA, GL_FLOAT, filled.data());
  return gl_status("receivers");
}

Status SpotReceivers::set(const Floats& floats, std::span<const double> in_double, int columns,
                          std::span<const GlossLobe> gloss, std::span<const std::uint32_t> words) {
  count_ = 0;  // until they are there
  const std::size_t count = floats.p_xyzw.size() / 4;
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  const auto side = static_cast<std::size_t>(most);
  const std::size_t wide = columns > 0 ? static_cast<std::size_t>(columns) : std::min<std::size_t>(count, 1024);
  // As wide as asked for, unless that is too high.
  const std::size_t row = std::max<std::size_t>(count > wide * side ? side : std::min(wide, side), 1);
  const std::size_t rows = (count + row - 1) / row;
  if (rows > side) return fail("more than " + std::to_string(side * side), "receivers", "render in parts");
  columns_ = static_cast<int>(row);
  rows_ = static_cast<int>(rows);
  if (count == 0) return {};

  if (const Status done = fill(positions_, floats.p_xyzw); !done) return done;
  if (const Status done = fill(normals_, floats.n_xyzw); !done) return done;
  if (!floats.face_xyzw.empty())
    if (const Status done = fill(faces_, floats.face_xyzw); !done) return done;
  if (!gloss.empty()) {
    std::vector<float> eyes, colours;
    eyes.reserve(4 * count);
    colours.reserve(4 * count);
    for (const GlossLobe& l : gloss) {
      eyes.insert(eyes.end(), {l.eye_x, l.eye_y, l.eye_z, l.shape});
      colours.insert(colours.end(), {l.r, l.g, l.b, static_cast<float>(l.kind)});
    }
    if (const Status done = fill(lobe_eyes_, eyes); !done) return done;
    if (const Status done = fill(lobe_colours_, colours); !done) return done;
  }
  if (!in_double.empty())
    if (const Status done = fill_buffer(numbers_, std::as_bytes(in_double), "receivers"); !done) return done;
  if (!words.empty())
    if (const Status done = fill_buffer(words_, std::as_bytes(words), "tiles seen"); !done) return done;
  count_ = count;
  return {};
}

void SpotReceivers::bind() {
  bind_texture(SpotUnits::positions, positions_);
  bind_texture(SpotUnits::normals, normals_);
  bind_texture(SpotUnits::faces, faces_);
  bind_texture(SpotUnits::lobe_eyes, lobe_eyes_);
  bind_texture(SpotUnits::lobe_colours, lobe_colours_);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SpotBindings::receivers, numbers_.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SpotBindings::words, words_.id());
}

}  // namespace lumifield
