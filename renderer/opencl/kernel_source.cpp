#include "renderer/opencl/kernel_source.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace lumifield {

Result<KernelSource> kernel_source(std::string_view name) {
  for (int k = 0; k < embedded_kernel_count; ++k) {
    const EmbeddedKernel& kernel = embedded_kernels[k];
    if (name != kernel.name) continue;
    const char* root = std::getenv("LUMIFIELD_KERNELS");
    if (!root) return KernelSource{kernel.text, ""};

    const std::string path = std::string(root) + "/" + kernel.path;
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    if (!file) return fail("cannot be read", path, "let LUMIFIELD_KERNELS name the root of the sources, or unset it");
    return KernelSource{text.str(), "-I " + std::string(root)};
  }
  return fail("no kernel of this name is built in", std::string(name));
}

}  // namespace lumifield
