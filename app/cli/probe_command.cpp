#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/cli/commands.h"
#include "app/cli/points_csv.h"
#include "app/cli/print_result.h"
#include "luminaire/dataset.h"
#include "renderer/methods/device_method.h"
#include "renderer/methods/host_method.h"

namespace lumifield {

namespace {

/// As people count.
std::string point_name(std::size_t k, std::size_t count) {
  return "point " + std::to_string(k + 1) + " of " + std::to_string(count);
}

Result<std::vector<double>> probe_host(const LightField& light_field, const std::vector<Receiver>& points,
                                       const MethodSettings& settings) {
  const auto form = make_host_method(light_field, settings);
  if (!form) return tl::unexpected(form.error());
  std::vector<double> irradiance;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto e = (*form)->irradiance(points[k], static_cast<std::uint32_t>(k));
    if (!e) return fail_in(point_name(k, points.size()), e.error());
    irradiance.insert(irradiance.end(), e->begin(), e->end());
  }
  return irradiance;
}

Result<std::vector<double>> probe_opencl_device(const LightField& light_field, const std::vector<Receiver>& points,
                                                const MethodSettings& settings) {
  auto method = make_device_method(light_field.geometry(), settings);
  if (!method) return tl::unexpected(method.error());
  if (Status set = (*method)->set_cells(light_field); !set) return tl::unexpected(set.error());
  if (Status set = (*method)->set_receivers(points); !set) return tl::unexpected(set.error());
  if (const auto done = (*method)->evaluate(HUGE_VAL); !done) return tl::unexpected(done.error());
  std::vector<double> irradiance;
  if (Status read = (*method)->read(irradiance); !read) return tl::unexpected(read.error());
  return irradiance;
}

/// By the host form, whichever computes the light.
Result<std::vector<double>> stated_errors(const LightField& light_field, const std::vector<Receiver>& points,
                                          const MethodSettings& settings) {
  const auto form = make_host_method(light_field, settings);
  if (!form) return tl::unexpected(form.error());
  std::vector<double> stated;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto estimate = (*form)->estimate(points[k], static_cast<std::uint32_t>(k));
    if (!estimate) return fail_in(point_name(k, points.size()), estimate.error());
    stated.insert(stated.end(), estimate->stated_error.begin(), estimate->stated_error.end());
  }
  return stated;
}

Result<nlohmann::ordered_json> probe(const ProbeOptions& options) {
  auto points = read_points_csv(options.points);
  if (!points) return tl::unexpected(points.error());
  auto dataset = read_dataset(options.luminaire);
  if (!dataset) return tl::unexpected(dataset.error());
  for (const std::string& note : dataset->index.notes) std::fprintf(stderr, "lumifield: note: %s\n", note.c_str());
  const Coverage coverage = dataset->light_field.coverage();
  if (!coverage.complete())
    std::fprintf(stderr, "lumifield: note: %d of %d cells are unmeasured and add nothing\n",
                 coverage.total - coverage.measured, coverage.total);

  const MethodSettings settings = method_settings(options);
  if (settings.method == Method::reference && options.device == "opencl")
    return fail("the reference has no OpenCL form", "--device", "take host, or the closed form");
  const auto start = std::chrono::steady_clock::now();
  auto irradiance = options.device == "opencl" ? probe_opencl_device(dataset->light_field, *points, settings)
                                               : probe_host(dataset->light_field, *points, settings);
  if (!irradiance) return tl::unexpected(irradiance.error());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  std::vector<double> stated;
  if (options.stated_error) {
    auto errors = stated_errors(dataset->light_field, *points, settings);
    if (!errors) return tl::unexpected(errors.error());
    stated = std::move(*errors);
  }
  const LuminaireGeometry& geometry = dataset->light_field.geometry();
  if (Status written = write_points_csv(options.out, *points, geometry.channels, *irradiance, stated); !written)
    return tl::unexpected(written.error());
  nlohmann::ordered_json summary{{"points", points->size()}};
  summary.update(method_summary(settings));
  summary.update(nlohmann::ordered_json{{"device", options.device},
                                        {"unit", irradiance_unit_of(geometry.quantity)},
                                        {"cells", coverage.measured},
                                        {"cells_total", coverage.total},
                                        {"time_s", seconds},
                                        {"out", options.out}});
  return summary;
}

}  // namespace

int run_probe(const ProbeOptions& options) {
  return print_result(probe(options), options.json, [](const nlohmann::ordered_json& r) {
    char figures[64];
    std::snprintf(figures, sizeof figures, "%d points in %s, %.3f s", r["points"].get<int>(),
                  r["unit"].get<std::string>().c_str(), r["time_s"].get<double>());
    return r["out"].get<std::string>() + ": irradiance of " + figures;
  });
}

}  // namespace lumifield
