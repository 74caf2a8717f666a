#include "renderer/methods/table_memory.h"

#include <algorithm>
#include <cstdio>
#include <unistd.h>

#include "renderer/methods/lobe_sampling.h"
#include "renderer/methods/mis.h"
#include "renderer/methods/precomputed_lights.h"

namespace lumifield {

double lobe_table_bytes(const MethodSettings& settings) {
  const auto bytes = [&](int n) { return static_cast<double>(lobe_table(settings.sequence, n) * sizeof(LobePoint)); };
  if (settings.method == Method::filtered_brdf) return 2 * bytes(whole_samples(settings.samples));
  if (settings.method != Method::mis) return 0;
  const MisCounts counts = mis_counts(settings.samples);
  return bytes(counts.diffuse) + bytes(counts.glossy);
}

double host_table_bytes(const LuminaireGeometry& geometry, const MethodSettings& settings, int cells) {
  const Measurement& m = geometry.measurement;
  // The importance, and its sums from the corner; of cdfs each column, and its sums from the top.
  const double summed_area =
      sizeof(double) * (static_cast<double>(m.pixels()) + (m.width_px + 1.0) * (m.height_px + 1.0));
  const double cdfs = sizeof(double) * m.width_px * (2.0 * m.height_px + 1);
  const double coarser_levels =
      cells * static_cast<double>(m.pixels()) * static_cast<double>(geometry.channels.size()) * sizeof(double) / 3;
  switch (settings.method) {
    case Method::position_dependent:
      return cells * summed_area;
    case Method::position_dependent_printed:
      return cells * (summed_area + cdfs);
    case Method::precomputed_lights:
      return std::min(cells, 1) * (summed_area + cdfs) + settings.samples * sizeof(PrecomputedLight);
    case Method::closed_form:
    case Method::reference: {
      // |C|, which the stated error is measured against; with a level of detail means and deviations of all levels.
      const double levels = settings.lod > 0 ? 2.0 * sizeof(double) / 3 : 0;
      return cells * static_cast<double>(m.pixels()) * static_cast<double>(geometry.channels.size()) *
             (sizeof(float) + levels);
    }
    case Method::shift_invariant:
      // Levels of detail of a look-up.
      return settings.spots.look_up == SpotLookUp::weighted ? 0 : coarser_levels;
    case Method::filtered_brdf:
      return lobe_table_bytes(settings) + (settings.filter ? coarser_levels : 0);
    case Method::mis:
      return lobe_table_bytes(settings) + cells * summed_area + (settings.filter ? coarser_levels : 0);
    case Method::uniform_box:
    case Method::far_field:  // its table is bounded where it is made
      break;
  }
  return 0;
}

Status check_table_memory(const MethodSettings& settings, double table_bytes, double memory_bytes) {
  const double allowed = settings.memory_bytes > 0 ? settings.memory_bytes : memory_bytes / 2;
  if (table_bytes <= allowed) return {};
  char text[128];
  std::snprintf(text, sizeof text, "its tables take %.3g MB, more than the %.3g MB that they may", table_bytes / 1e6,
                allowed / 1e6);
  return fail(text, std::string(to_string(settings.method)),
              std::string("use closed-form, ") + (lobe_table_bytes(settings) > 0 ? "fewer samples, " : "") +
                  "smaller images or fewer cells");
}

double host_memory_bytes() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace lumifield
