#include "luminaire/nearest_word.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace lumifield {
namespace {

/// Levenshtein's distance, row by row.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (const char letter : a) {
    std::size_t diagonal = row[0]++;
    for (std::size_t k = 0; k < b.size(); ++k) {
      const std::size_t other = diagonal + (letter == b[k] ? 0 : 1);
      diagonal = row[k + 1];
      row[k + 1] = std::min({other, diagonal + 1, row[k] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::optional<std::string> nearest_word(std::string_view wanted, std::span<const std::string> words) {
  std::optional<std::string> nearest;
  std::size_t most = wanted.size() / 3 + 1;
  for (const std::string& word : words) {
    if (word.size() > wanted.size() + most) continue;  // it may be long
    const std::size_t off = distance(wanted, word);
    if (off > most || (nearest && off == most)) continue;
    nearest = word;
    most = off;
  }
  return nearest;
}

}  // namespace lumifield
