#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/cli/commands.h"
#include "app/cli/noted_files.h"
#include "app/cli/piecewise.h"
#include "app/cli/points_csv.h"
#include "app/cli/print_result.h"
#include "app/cli/stop_signal.h"
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
  Piecewise pieces(with_stated_error ? "irradiance and stated error" : "irradiance");
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (Status done = pieces.done(static_cast<double>(k) / static_cast<double>(points.size())); !done)
      return tl::unexpected(done.error());
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
  Piecewise pieces("irradiance");
  for (bool all = false; !all;) {
    const auto evaluated = (*method)->evaluate(piece_s);
    if (!evaluated) return tl::unexpected(evaluated.error());
    all = *evaluated;
    if (Status done = pieces.done((*method)->share_done()); !done) return tl::unexpected(done.error());
  }
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

/// What the values do not tell by themselves.
void print_value_notes(const std::vector<Receiver>& points, const MethodInfo& method, const Values& values) {
  const auto count_of = [&](std::ptrdiff_t count) {
    return std::to_string(count) + " of " + std::to_string(points.size()) + " points";
  };
  const auto behind = std::ranges::count_if(points, [](const Receiver& r) { return !(r.p_mm.z() > 0); });
  if (behind > 0) print_note(count_of(behind) + " are behind the luminaire or in its plane (z_mm of 0 or less): 0");
  if (method.samples == 0 || values.stated_error.empty()) return;
  // As the study refuses.
  constexpr double largest_share = 0.25;
  const std::size_t channels = values.irradiance.size() / points.size();
  std::ptrdiff_t unsure = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    bool any = false;
    for (std::size_t c = k * channels; c < (k + 1) * channels; ++c)
      any = any || values.stated_error[c] > largest_share * std::abs(values.irradiance[c]);
    unsure += any;
  }
  if (unsure > 0)
    print_note("at " + count_of(unsure) +
               " the stated error is above a quarter of the value: take more --samples, or " + "closed-form");
}

Result<nlohmann::ordered_json> probe(const ProbeOptions& options) {
  const MethodSettings settings = method_settings(options);
  if (settings.method == Method::reference && options.device == "opencl")
    return fail("the reference has no OpenCL form", "--device", "take host, or the closed form");
  if (Status writable = check_writable(options.out); !writable) return tl::unexpected(writable.error());
  stop_on_signals();
  std::vector<std::string> notes;
  auto points = read_points_csv(options.points, notes);
  if (!points) return tl::unexpected(points.error());
  for (const std::string& note : notes) print_note(note);
  auto dataset = read_noted_dataset(options.luminaire);
  if (!dataset) return tl::unexpected(dataset.error());
  const auto start = std::chrono::steady_clock::now();
  const auto probed = options.device == "opencl" ? by_device_form : by_host_form;
  const auto values = probed(dataset->light_field, *points, settings, options.stated_error);
  if (!values) return tl::unexpected(values.error());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  print_value_notes(*points, info(settings.method), *values);

  const Coverage coverage = dataset->light_field.coverage();
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
