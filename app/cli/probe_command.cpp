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

/// Of the points, channel by channel each.
struct Values {
  std::vector<double> irradiance, stated_error;  ///< the second only where it is asked for
};

Result<Values> by_host_form(const LightField& light_field, const std::vector<Receiver>& points,
                            const MethodSettings& settings, bool with_stated_error) {
  const auto form = make_host_method(light_field, settings);
  if (!form) return tl::unexpected(form.error());
  Values values;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto number = static_cast<std::uint32_t>(k);
    const Result<Estimate> one = with_stated_error
                                     ? (*form)->estimate(points[k], number)
                                     : (*form)->irradiance(points[k], number).map([](std::vector<double> e) {
                                         return Estimate{std::move(e), {}};
                                       });
    if (!one) return fail_in(point_name(k, points.size()), one.error());
    values.irradiance.insert(values.irradiance.end(), one->irradiance.begin(), one->irradiance.end());
    values.stated_error.insert(values.stated_error.end(), one->stated_error.begin(), one->stated_error.end());
  }
  return values;
}

/// What `--device opencl` is of a method.
std::string device_of(const ProbeOptions& options, Method method) {
  return options.device == "opencl" && !needs_opencl(method) ? "opengl" : options.device;
}

Result<std::vector<double>> probe_device(const LightField& light_field, const std::vector<Receiver>& points,
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

/// The stated error comes from the host form, whichever computes the light.
Result<Values> by_device_form(const LightField& light_field, const std::vector<Receiver>& points,
                              const MethodSettings& settings, bool with_stated_error) {
  auto irradiance = probe_device(light_field, points, settings);
  if (!irradiance) return tl::unexpected(irradiance.error());
  Values values{std::move(*irradiance), {}};
  if (with_stated_error) {
    auto stated = by_host_form(light_field, points, settings, true);
    if (!stated) return stated;
    values.stated_error = std::move(stated->stated_error);
  }
  return values;
}

Result<nlohmann::ordered_json> probe(const ProbeOptions& options) {
  auto points = read_points_csv(options.points);
  if (!points) return tl::unexpected(points.error());
  auto dataset = read_dataset(options.luminaire);
  if (!dataset) return tl::unexpected(dataset.error());
  print_notes(dataset->index.notes);
  const Coverage coverage = dataset->light_field.coverage();
  if (!coverage.complete())
    std::fprintf(stderr, "lumifield: note: %d of %d cells are unmeasured and add nothing\n",
                 coverage.total - coverage.measured, coverage.total);

  const MethodSettings settings = method_settings(options);
  if (settings.method == Method::reference && options.device == "opencl")
    return fail("the reference has no OpenCL form", "--device", "take host, or the closed form");
  const auto start = std::chrono::steady_clock::now();
  const auto probed = options.device == "opencl" ? by_device_form : by_host_form;
  const auto values = probed(dataset->light_field, *points, settings, options.stated_error);
  if (!values) return tl::unexpected(values.error());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const LuminaireGeometry& geometry = dataset->light_field.geometry();
  if (Status written =
          write_points_csv(options.out, *points, geometry.channels, values->irradiance, values->stated_error);
      !written)
    return tl::unexpected(written.error());
  nlohmann::ordered_json summary{{"points", points->size()}};
  summary.update(method_summary(settings));
  summary.update(nlohmann::ordered_json{{"device", device_of(options, settings.method)},
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
