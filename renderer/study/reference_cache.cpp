#include "renderer/study/reference_cache.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "luminaire/file_io.h"
#include "renderer/methods/device_method.h"

namespace lumifield {

namespace {

template <class T>
void append(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

}  // namespace

std::string reference_key(const LightField& light_field, const std::vector<Receiver>& receivers,
                          const Appearance& appearance, int version) {
  const LuminaireGeometry& g = light_field.geometry();
  const Sampling& s = g.sampling;
  const Measurement& m = g.measurement;
  const double lengths[] = {g.planes.separation_mm, s.spacing_mm.x(), s.spacing_mm.y(),
                            s.center_mm.x(),        s.center_mm.y(),  m.pixel_mm.x(),
                            m.pixel_mm.y(),         m.center_mm.x(),  m.center_mm.y()};
  const int counts[] = {static_cast<int>(s.basis),          s.columns, s.rows, m.width_px, m.height_px,
                        static_cast<int>(g.channels.size())};
  std::string bytes = "lumifield-reference " + std::to_string(version) + "\n";
  append(bytes, lengths, std::size(lengths));
  append(bytes, counts, std::size(counts));
  for (const Receiver& r : receivers) {
    append(bytes, r.p_mm.data(), 3);
    append(bytes, r.n.data(), 3);
  }
  if (!appearance.gloss.empty()) append(bytes, appearance.gloss.data(), appearance.gloss.size());
  const TileVisibility& visible = appearance.visible;
  if (!visible.empty()) {
    bytes += visible.weighing == ShadowWeighing::tile ? "tile" : "mean";
    append(bytes, visible.words.data(), visible.words.size());
  }
  // Cell by cell, so that no copy of the luminaire is made.
  std::string key = sha256_hex(bytes);
  for (int flat = 0; flat < s.cells(); ++flat) {
    const auto image = light_field.cell(s.index(flat));
    std::string cell = key + std::to_string(flat);
    if (image) append(cell, image->value.data(), image->value.size());
    key = sha256_hex(cell);
  }
  return key;
}

std::filesystem::path cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
    return std::filesystem::path(cache) / "lumifield";
  if (const char* home = std::getenv("HOME"); home && *home) return std::filesystem::path(home) / ".cache/lumifield";
  return {};
}

namespace {

/// What is kept and whole.
std::optional<std::vector<double>> kept_values(const std::filesystem::path& file, std::size_t count) {
  const auto kept = read_file(file, count * sizeof(double));
  if (!kept || kept->size() != count * sizeof(double)) return std::nullopt;
  std::vector<double> values(count);
  std::memcpy(values.data(), kept->data(), kept->size());
  for (const double value : values)
    if (!std::isfinite(value)) return std::nullopt;
  return values;
}

}  // namespace

Result<std::vector<double>> cached_reference(const LightField& light_field, const std::vector<Receiver>& receivers,
                                             const Appearance& appearance, const std::filesystem::path& folder) {
  const std::size_t channels = light_field.geometry().channels.size();
  const std::size_t count = receivers.size() * (channels + appearance.gloss_channels(channels));
  const std::filesystem::path file = folder / (reference_key(light_field, receivers, appearance) + ".f64");
  if (!folder.empty())
    if (auto kept = kept_values(file, count)) return std::move(*kept);

  const auto method = make_device_method(light_field.geometry(), {.method = Method::reference});
  if (!method) return tl::unexpected(method.error());
  std::vector<double> light, gloss;
  const Status done = (*method)
                          ->set_cells(light_field)
                          .and_then([&] { return (*method)->set_receivers(receivers, appearance); })
                          .and_then([&]() -> Status {
                            if (const auto evaluated = (*method)->evaluate(HUGE_VAL); !evaluated)
                              return tl::unexpected(evaluated.error());
                            return {};
                          })
                          .and_then([&] { return (*method)->read(light); })
                          .and_then([&] { return (*method)->read_gloss(gloss); });
  if (!done) return tl::unexpected(done.error());
  light.insert(light.end(), gloss.begin(), gloss.end());
  if (folder.empty()) return light;
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  (void)write_file_durably(file, {reinterpret_cast<const char*>(light.data()), light.size() * sizeof(double)});
  return light;
}

}  // namespace lumifield
