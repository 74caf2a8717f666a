#include "luminaire/exr_reason.h"

#include <string_view>

namespace lumifield {

std::string exr_reason(const std::exception& thrown) {
  constexpr std::string_view unnamed = " \"(string)\"";
  std::string text = thrown.what();
  for (std::size_t at; (at = text.find(unnamed)) != std::string::npos;) text.erase(at, unnamed.size());
  text.erase(text.find_last_not_of(". \n") + 1);
  return text;
}

}  // namespace lumifield
