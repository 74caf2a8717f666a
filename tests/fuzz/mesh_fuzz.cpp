#include <cstdint>
#include <cstdlib>
#include <string>
#include <sys/mman.h>
#include <unistd.h>

#include "renderer/scene/mesh.h"
/// OBJ text as a file in memory: a mesh or an Error, never a crash; what is read holds together.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int fd = memfd_create("mesh", MFD_CLOEXEC);
  if (fd < 0 || write(fd, data, size) != static_cast<ssize_t>(size)) std::abort();
  const auto mesh = lumifield::read_mesh("/proc/self/fd/" + std::to_string(fd));
  close(fd);
  if (!mesh) return 0;
  if (mesh->triangles() == 0 || mesh->vertices.size() != 3 * mesh->triangles()) std::abort();
  for (const std::uint32_t m : mesh->material)
    if (m >= mesh->materials.size()) std::abort();
  return 0;
}
