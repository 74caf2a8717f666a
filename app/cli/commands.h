#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/cli/command_line.h"
#include "luminaire/error.h"
#include "renderer/methods/method.h"

namespace lumifield {

/// Of the tone curve: a lamp's beam is far brighter than the average of the scene that it lights.
inline constexpr double default_exposure = 0.3;

enum ExitCode { exit_done = 0, exit_failed = 1, exit_wrong_use = 2, exit_stopped = 3 };

/// Prints an error to stderr, and how to go on on a line of its own; with --json as {"error": …} to stdout too. Returns
/// exit_failed, or exit_stopped.
int report_error(const Error& error, bool json, const std::string& go_on = {});

struct ScanOptions {
  std::string bench, plan, out, preview, pictures;
  std::string record;  ///< folder for all frames, to be played back; empty: none
  std::string size = "1024x768";
  double exposure = default_exposure;
  bool resume = false, accept_drift = false, json = false;
};
int run_scan(const ScanOptions& options);

struct RehearseOptions {
  std::string bench, plan, out = ".";
  std::vector<int> cell;  ///< row, column of the test shot; empty: the reference cell
  bool json = false;
};
int run_rehearse(const RehearseOptions& options);

struct RenderOptions {
  std::string luminaire, scene, method = "closed-form", filter = "on", spots = "weighted", shadows = "tile",
                                size = "1024x768", out;
  std::string environment;  ///< "on", "off"; empty: on where the scene names one
  double exposure = default_exposure, white = 0;
  double lod = 0;      ///< pixels per support and axis, 0 exact
  double samples = 0;  ///< K for each receiver, or lights in all; 0: the method's usual
  std::uint32_t seed = 1;
  bool json = false;
};
int run_render(const RenderOptions& options);

struct ProbeOptions {
  std::string luminaire, points, method = "closed-form", filter = "on", spots = "weighted", device = "host", out;
  double lod = 0;      ///< pixels per support and axis, 0 exact
  double samples = 0;  ///< K for each receiver, or lights in all; 0: the method's usual
  std::uint32_t seed = 1;
  bool stated_error = false;  ///< how far off each value may be, too
  bool json = false;
};
int run_probe(const ProbeOptions& options);

struct CheckOptions {
  std::vector<std::string> paths;
  bool json = false;
};
int run_check(const CheckOptions& options);

struct DevicesOptions {
  std::string bench, stage_path;
  int frames = 0;  ///< to take with the bench's camera
  double exposure_s = 0.001;
  bool json = false;
};
int run_devices(const DevicesOptions& options);

struct StudyOptions {
  std::vector<std::string> luminaires;  ///< dataset folders or built-in names; none: all that are built in
  std::string scene, out;
  std::string cache;  ///< folder of references kept; empty: cache_folder()
  bool quick = false, ladders_only = false, force = false, json = false;
};
int run_study_command(const StudyOptions& options, WriteStudyChart write_chart);

/// Of --method, --lod, --samples, --filter, --spots and --seed, which were checked.
template <class Options>
MethodSettings method_settings(const Options& options) {
  MethodSettings settings{.method = method_from_string(options.method).value_or(Method::closed_form),
                          .lod = options.lod,
                          .seed = options.seed,
                          .filter = options.filter == "on"};
  settings.spots.look_up = spot_look_up_from_string(options.spots).value_or(SpotLookUp::weighted);
  const double usual = info(settings.method).samples;
  if (options.samples > 0 || usual > 0) settings.samples = options.samples > 0 ? options.samples : usual;
  return settings;
}

/// "1024x768" → width, height, each 1 … 16384.
Result<std::pair<int, int>> parse_size(const std::string& text);

}  // namespace lumifield
