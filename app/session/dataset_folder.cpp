#include "app/session/dataset_folder.h"

#include <array>
#include <system_error>

namespace lumifield {
namespace fs = std::filesystem;

Status remove_empty_dataset(const fs::path& folder) {
  const std::array parts{"halves", "cells", "journal.jsonl", "luminaire.json"};
  const auto refused = [&](const fs::path& path, const std::error_code& code) {
    return fail("could not be removed from the empty dataset: " + code.message(), path.string(), "remove it by hand");
  };

  // Nothing but what a writer makes.
  std::error_code code;
  for (fs::directory_iterator at(folder, code), end; !code && at != end; at.increment(code)) {
    bool known = false;
    for (const char* part : parts) known = known || at->path().filename() == part;
    if (!known)
      return fail("is kept, though the dataset has no cells", at->path().string(), "look at it, then remove it");
  }
  if (code) return refused(folder, code);

  // `halves` and `cells` first: each is refused while it holds a file.
  for (const char* part : parts)
    if (fs::remove(folder / part, code); code) return refused(folder / part, code);
  if (fs::remove(folder, code); code) return refused(folder, code);
  return {};
}

}  // namespace lumifield
