#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <sys/mman.h>
#include <unistd.h>

#include "renderer/scene/texture.h"

/// PNG or OpenEXR as a file in memory: a texture whose values are sound, or an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int fd = memfd_create("texture", MFD_CLOEXEC);
  if (fd < 0 || write(fd, data, size) != static_cast<ssize_t>(size)) std::abort();
  constexpr std::size_t most_pixels = 1 << 16;
  const auto texture = lumifield::read_texture("/proc/self/fd/" + std::to_string(fd), most_pixels);
  close(fd);
  if (!texture) return 0;
  const auto pixels = static_cast<std::size_t>(texture->width_px) * static_cast<std::size_t>(texture->height_px);
  if (pixels == 0 || pixels > most_pixels || texture->rgb.size() != 3 * pixels) std::abort();
  for (const float value : texture->rgb)
    if (!(value >= 0 && std::isfinite(value))) std::abort();
  return 0;
}
