#include "renderer/shift_invariant/spot_receivers.h"

#include <algorithm>
#include <epoxy/gl.h>
#include <string>

#include "renderer/bands.h"
#include "renderer/shift_invariant/spot_program.h"

namespace lumifield {

namespace {

/// What receivers have `each` of, in their texels' order; 0 where there is none.
template <class T>
std::vector<T> in_order(const SpotOrder& order, std::span<const T> list, std::size_t each) {
  std::vector<T> ordered(order.receiver.size() * each);
  in_bands(order.receiver.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      if (order.receiver[k] != SpotOrder::none)
        std::copy_n(list.data() + order.receiver[k] * each, each, ordered.data() + k * each);
  });
  return ordered;
}

void bind_texture(int unit, GlTexture& texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, texture.id());
}

template <class T>
Status fill_buffer(GlBuffer& buffer, const std::vector<T>& list, const char* what) {
  GLint64 most = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  const std::size_t bytes = list.size() * sizeof(T);
  if (bytes > static_cast<std::size_t>(most))
    return fail(std::string(what) + " take more than " + std::to_string(most / 1000000) + " MB", "receivers",
                "render in parts");
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer.id());
  glBufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(bytes), list.data(), GL_STREAM_DRAW);
  return gl_status(what);
}

}  // namespace

Status SpotReceivers::fill(GlTexture& texture, std::span<const float> four_each) {
  const std::vector<float> texels = in_order(order_, four_each, 4);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture.id());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, order_.columns, order_.rows, 0, GL_RGBA, GL_FLOAT, texels.data());
  return gl_status("receivers");
}

Status SpotReceivers::fill_lobes(std::span<const GlossLobe> gloss) {
  std::vector<float> eyes, colours;
  eyes.reserve(4 * gloss.size());
  colours.reserve(4 * gloss.size());
  for (const GlossLobe& l : gloss) {
    eyes.insert(eyes.end(), {l.eye_x, l.eye_y, l.eye_z, l.shape});
    colours.insert(colours.end(), {l.r, l.g, l.b, static_cast<float>(l.kind)});
  }
  if (const Status done = fill(lobe_eyes_, eyes); !done) return done;
  return fill(lobe_colours_, colours);
}

Status SpotReceivers::set(const LuminaireGeometry& geometry, const Given& given) {
  count_ = given.p_xyzw.size() / 4;
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  order_ = SpotOrder(geometry, given.p_xyzw, given.n_xyzw, given.picture_columns, most);
  if (empty()) return {};
  const auto refused = [&](const Status& status) {
    order_ = {};
    return status;
  };
  if (order_.rows > most)
    return refused(fail(std::to_string(count_) + " receivers have no texture", "receivers", "render in parts"));
  if (const Status done = fill(positions_, given.p_xyzw); !done) return refused(done);
  if (const Status done = fill(normals_, given.n_xyzw); !done) return refused(done);
  if (!given.face_xyzw.empty())
    if (const Status done = fill(faces_, given.face_xyzw); !done) return refused(done);
  if (!given.gloss.empty())
    if (const Status done = fill_lobes(given.gloss); !done) return refused(done);
  if (!given.numbers.empty())
    if (const Status done = fill_buffer(numbers_, in_order(order_, given.numbers, 6), "receivers"); !done)
      return refused(done);
  if (!given.words.empty())
    if (const Status done =
            fill_buffer(words_, in_order(order_, given.words, given.words.size() / count_), "tiles seen");
        !done)
      return refused(done);
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
