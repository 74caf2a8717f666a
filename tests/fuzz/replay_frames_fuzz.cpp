#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "acquisition/cameras/frame_folder.h"

/// A list that is read is read the same from what is written of it, and a picture that is read is of the size and depth
/// that it says.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumifield;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (const auto frames = parse_frame_list(bytes, "frames.csv")) {
    std::string once = frame_list_header(), twice = once;
    for (const ListedFrame& frame : *frames) once += frame_list_line(frame);
    const auto again = parse_frame_list(once, "frames.csv");
    if (!again || again->size() != frames->size()) std::abort();
    for (const ListedFrame& frame : *again) twice += frame_list_line(frame);
    if (once != twice) std::abort();
  }
  if (const auto image = decode_pgm(bytes, "a.pgm")) {
    if (image->dn.size() != static_cast<std::size_t>(image->width_px) * static_cast<std::size_t>(image->height_px))
      std::abort();
    for (const std::uint16_t dn : image->dn)
      if (dn >> image->bits != 0) std::abort();
  }
  return 0;
}
