#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lumifield {

/// Which of `words` may be meant for `wanted`, misspelt: the one that the fewest letters left out, put in or taken for
/// another lead to, a third of its own and one at most; of equals the first. Reentrant.
std::optional<std::string> nearest_word(std::string_view wanted, std::span<const std::string> words);

}  // namespace lumifield
