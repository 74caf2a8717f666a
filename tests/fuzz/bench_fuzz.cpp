#include <cstdint>
#include <cstdlib>

#include "luminaire/bench.h"

/// A bench file that is read comes back the same after writing.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto bench = lumifield::parse_bench(text, "bench.json");
  if (!bench) return 0;
  const std::string once = lumifield::to_json(*bench);
  const auto again = lumifield::parse_bench(once, "bench.json");
  if (!again || lumifield::to_json(*again) != once) std::abort();
  return 0;
}
