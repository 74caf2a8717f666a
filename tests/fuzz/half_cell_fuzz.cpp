#include <cstdint>
#include <cstdlib>
#include <string>

#include "luminaire/file_io.h"
#include "luminaire/half_cell_file.h"

namespace {

void check(const lumifield::Bracket& bracket) {
  for (const lumifield::RawImage& frame : bracket)
    if (frame.dn.size() != static_cast<std::size_t>(frame.width_px) * static_cast<std::size_t>(frame.height_px))
      std::abort();
}

}  // namespace

/// Frames that are read are of the size that they say. The bytes stand behind the checksum, which is made here.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumifield;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (decode_half_cell(bytes, "half")) std::abort();  // without its checksum
  const std::string sealed = sha256_hex(bytes) + "\n" + std::string(bytes);
  if (const auto half = decode_half_cell(sealed, "half")) check(half->half.raw.passes.front().bracket);
  if (const auto dark = decode_dark_set(sealed, "dark")) check(dark->bracket);
  return 0;
}
