#pragma once

#include <array>
#include <span>
#include <string>

#include "luminaire/error.h"

namespace lumifield {

/// What passes that draw a mesh share, on the context that is current. Names of OpenGL's objects and its enumerations
/// are plain numbers here, as they are there. Thread-bound to the context's thread.

/// What OpenGL has found wrong since it was last asked. `what` was being done.
Status gl_status(const std::string& what);

/// The texts of a program; without a geometry shader, null.
struct ShaderTexts {
  const char* vertex;
  const char* geometry;
  const char* fragment;
};

/// Errors: the driver's log. `whose` shaders they are, for messages.
Result<unsigned> compile_program(const std::string& whose, const ShaderTexts& texts);

/// A texture, or a buffer; none until it is made. It goes with its owner, on the context that is current then.
class GlTexture {
 public:
  GlTexture() = default;
  GlTexture(GlTexture&& other) noexcept;
  GlTexture& operator=(GlTexture&& other) noexcept;
  ~GlTexture();
  /// Makes it where there is none.
  unsigned id();

 private:
  unsigned id_ = 0;
};

class GlBuffer {
 public:
  GlBuffer() = default;
  GlBuffer(GlBuffer&& other) noexcept;
  GlBuffer& operator=(GlBuffer&& other) noexcept;
  ~GlBuffer();
  unsigned id();

 private:
  unsigned id_ = 0;
};

/// A framebuffer with up to four colour images of the given formats, and 32-bit depth where wanted; bound when made.
/// `picture` in messages. Errors: no memory, a combination that the driver does not draw to.
class RenderTarget {
 public:
  static Result<RenderTarget> create(const std::string& picture, int width_px, int height_px,
                                     std::span<const unsigned> colour_formats, bool depth);
  RenderTarget(RenderTarget&& other) noexcept;
  RenderTarget& operator=(RenderTarget&&) = delete;
  ~RenderTarget();

 private:
  RenderTarget() = default;
  unsigned framebuffer_ = 0;
  std::array<unsigned, 5> images_{};
};

}  // namespace lumifield
