#include "app/cli/noted_files.h"

#include <cstdio>
#include <set>

#include "luminaire/manifest.h"

namespace lumifield {
namespace fs = std::filesystem;

void print_note(const std::string& note) { std::fprintf(stderr, "lumifield: note: %s\n", note.c_str()); }

Result<Scene> read_noted_scene(const fs::path& file) {
  std::vector<std::string> notes;
  auto scene = read_scene(file, &notes, ReaderNotes::ignored);
  for (const std::string& note : notes) print_note(note);
  return scene;
}

std::string datasets_within(const fs::path& folder) {
  std::error_code code;
  if (fs::exists(folder / manifest_name, code)) return {};
  std::set<std::string> found;
  for (fs::directory_iterator at(folder, code), end; !code && at != end; at.increment(code))
    if (std::error_code unread; fs::exists(at->path() / manifest_name, unread)) found.insert(at->path().string());
  std::string text;
  for (const std::string& each : found) text += (text.empty() ? "" : ", ") + each;
  return text;
}

Result<Dataset> read_noted_dataset(const fs::path& folder) {
  if (const std::string within = datasets_within(folder); !within.empty())
    return fail("is no dataset, but a folder that holds " + within, folder.string(), "name what it holds");
  auto dataset = read_dataset(folder);
  if (!dataset) return dataset;
  for (const std::string& note : dataset->index.notes) print_note(note);
  const Coverage coverage = dataset->light_field.coverage();
  if (!coverage.complete())
    print_note(folder.string() + ": " + std::to_string(coverage.total - coverage.measured) + " of " +
               std::to_string(coverage.total) + " cells are unmeasured; their light is missing");
  return dataset;
}

}  // namespace lumifield
