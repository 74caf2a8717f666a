#pragma once

#include <memory>
#include <string>

#include "luminaire/error.h"

namespace lumifield {

/// An OpenGL ≥ 4.3 core context without a window system: a hardware device of EGL's device platform, else Mesa's
/// surfaceless platform, else a software device, else a pbuffer on the default display. Drawing goes to framebuffer
/// objects. Thread-bound: the creating thread keeps the context current for life.
class EglContext {
 public:
  /// Errors: no libEGL, no display that can be initialised, none with OpenGL 4.3 core; each candidate's reason is told.
  static Result<std::unique_ptr<EglContext>> create();
  ~EglContext();

  /// Needed before drawing only where a thread owns several contexts.
  Status make_current();
  /// Renderer and version: "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5 (Core Profile) Mesa 22.3.6 (device)".
  std::string description() const;

 private:
  struct Impl;
  explicit EglContext(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield
