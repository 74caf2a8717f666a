#pragma once

#include <string>
#include <string_view>

#include "luminaire/error.h"

namespace lumifield {

/// A kernel's text as built into the program, its #include lines resolved.
struct EmbeddedKernel {
  const char* name;  ///< the file's stem
  const char* path;  ///< from the root of the sources
  const char* text;
};

extern const EmbeddedKernel embedded_kernels[];
extern const int embedded_kernel_count;

struct KernelSource {
  std::string text;
  std::string options;  ///< for the compiler
};

/// The text of a kernel by its file's stem. With LUMIFIELD_KERNELS naming the root of a source tree it is read from
/// there, so that a kernel can be changed without building. Reentrant.
Result<KernelSource> kernel_source(std::string_view name);

}  // namespace lumifield
