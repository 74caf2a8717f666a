#include <cstdint>
#include <cstdlib>

#include "luminaire/plan.h"

/// A plan file that is read comes back the same after writing.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto plan = lumifield::parse_plan(text, "plan.json");
  if (!plan) return 0;
  const std::string once = lumifield::to_json(*plan);
  const auto again = lumifield::parse_plan(once, "plan.json");
  if (!again || lumifield::to_json(*again) != once) std::abort();
  return 0;
}
