#include <cstdint>
#include <cstdlib>

#include "luminaire/dataset.h"
#include "luminaire/manifest.h"

/// A manifest, and after a NUL the journal's lines: what is read comes back the same after writing.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumifield;
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const std::size_t end = input.find('\0');
  auto manifest = parse_manifest(input.substr(0, end), "luminaire.json");
  if (!manifest) return 0;
  std::string_view journal = end == std::string_view::npos ? std::string_view() : input.substr(end + 1);
  while (!journal.empty()) {
    const std::size_t newline = journal.find('\n');
    const auto entry = parse_journal_line(journal.substr(0, newline), manifest->geometry, "journal.jsonl");
    journal = newline == std::string_view::npos ? std::string_view() : journal.substr(newline + 1);
    if (!entry) continue;
    if (!manifest->geometry.sampling.contains(entry->cell)) std::abort();
    const std::string line = to_journal_line(*entry);
    const auto again = parse_journal_line(line, manifest->geometry, "journal.jsonl");
    if (!again || to_journal_line(*again) != line) std::abort();
    manifest->cells.push_back(*entry);
  }
  const std::string once = to_json(*manifest);
  const auto again = parse_manifest(once, "luminaire.json");
  if (!again || to_json(*again) != once) std::abort();
  if (first_difference(manifest->geometry, again->geometry)) std::abort();
  return 0;
}
