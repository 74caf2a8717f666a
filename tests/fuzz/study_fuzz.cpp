#include <cstdint>
#include <cstdlib>

#include "app/session/study_file.h"

/// What is read is written and read again as the same.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto study = lumifield::parse_study({reinterpret_cast<const char*>(data), size}, "study.json");
  if (!study) return 0;
  const std::string text = lumifield::study_json(*study);
  const auto again = lumifield::parse_study(text, "again.json");
  if (!again || lumifield::study_json(*again) != text) std::abort();
  return 0;
}
