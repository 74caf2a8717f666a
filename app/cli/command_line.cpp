#include "app/cli/command_line.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <type_traits>

#include "app/cli/commands.h"
#include "renderer/visibility/visibility.h"

namespace lumifield {

Result<std::pair<int, int>> parse_size(const std::string& text) {
  constexpr int largest = 16384;
  int width = 0, height = 0;
  const char* end = text.data() + text.size();
  auto [after, wrong] = std::from_chars(text.data(), end, width);
  if (wrong == std::errc() && after != end && *after == 'x') {
    auto [last, bad] = std::from_chars(after + 1, end, height);
    if (bad == std::errc() && last == end && width >= 1 && height >= 1 && width <= largest && height <= largest)
      return std::pair(width, height);
  }
  return fail("'" + text + "' is not a picture size", "--size", "write WIDTHxHEIGHT, each 1 to 16384, as in 1024x768");
}

namespace {

/// Each refuses as wrong use.
CLI::Validator picture_size() {
  const auto fault = [](const std::string& text) {
    const auto size = parse_size(text);
    return size ? std::string() : size.error().what + "; " + size.error().remedy;
  };
  return {fault, "WIDTHxHEIGHT"};
}
CLI::Validator picture_file() {
  const auto fault = [](const std::string& text) {
    const std::string extension = std::filesystem::path(text).extension().string();
    const bool known = extension == ".exr" || extension == ".png";
    return known ? std::string() : "the format of '" + text + "' is not known; end its name in .exr or .png";
  };
  return {fault, "FILE.exr|FILE.png"};
}
/// Of all text; NaN where it is no number, which no range holds.
double number_in(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [after, wrong] = std::from_chars(text.data(), end, value);
  return wrong == std::errc() && after == end ? value : std::nan("");
}
CLI::Validator level_of_detail() {
  const auto fault = [](const std::string& text) {
    const double pixels = number_in(text);
    const bool good = pixels == 0 || (pixels >= least_lod && std::isfinite(pixels));
    return good ? std::string() : "'" + text + "' is not a number of pixels per support; give 0 (exact), or 1 or more";
  };
  return {fault, "PIXELS"};
}
CLI::Validator number(const char* kind, double least, double most) {
  const auto fault = [=](const std::string& text) {
    const double value = number_in(text);
    return value >= least && value <= most ? std::string() : "'" + text + "' is not " + kind;
  };
  return {fault, "NUMBER"};
}
CLI::Validator positive() {
  return number("a number above 0", std::numeric_limits<double>::min(), std::numeric_limits<double>::max());
}
CLI::Validator not_below_zero() { return number("a number of 0 or more", 0, std::numeric_limits<double>::max()); }
/// Whole ones; 5e6 is one too.
CLI::Validator whole(const char* kind, double least, double most) {
  const auto fault = [=](const std::string& text) {
    const double value = number_in(text);
    const bool good = value >= least && value <= most && value == std::floor(value);
    return good ? std::string() : "'" + text + "' is not a whole number " + kind;
  };
  return {fault, "NUMBER"};
}
CLI::Validator sample_count() { return whole("of samples from 1 to 10 million", 1, most_samples); }
CLI::Validator seed_number() { return whole("from 0 to 4294967295", 0, std::numeric_limits<std::uint32_t>::max()); }
CLI::Validator method_name() {
  std::vector<std::string> names;
  for (const MethodInfo& each : methods()) names.emplace_back(each.name);
  return CLI::IsMember(names);
}

CLI::Validator visibility_name() {
  std::vector<std::string> names;
  for (const VisibilityInfo& each : visibilities()) names.emplace_back(each.name);
  return CLI::IsMember(names);
}

CLI::Validator dataset_folder() {
  const auto fault = [](const std::string& text) {
    std::error_code unknown;
    return std::filesystem::exists(text, unknown) ? std::string()
                                                  : "'" + text +
                                                        "' is neither a sub-command nor a dataset folder; "
                                                        "`lumifield --help` lists the sub-commands";
  };
  return {fault, "NAME.lumi"};
}

void add_bench(CLI::App* command, std::string& bench) {
  command->add_option("--bench", bench, "Bench file (required, here or in LUMIFIELD_BENCH)")
      ->envname("LUMIFIELD_BENCH");
  command->final_callback([&bench] {
    if (bench.empty()) throw CLI::RequiredError("--bench, or the environment variable LUMIFIELD_BENCH,");
  });
}

void add_scan(CLI::App& app, ScanOptions& o) {
  CLI::App* scan = app.add_subcommand("scan", "Scan a lamp without a window");
  add_bench(scan, o.bench);
  scan->add_option("--plan", o.plan, "Plan file")->required();
  scan->add_option("--out", o.out, "Dataset folder to make, NAME.lumi")->required();
  scan->add_flag("--resume", o.resume,
                 "Go on with a dataset that is there; where slides are changed by hand, the next one is in");
  scan->add_flag("--accept-drift", o.accept_drift,
                 "The drift of the reference cell that is read first is known, and so is a lamp that does not become "
                 "steady: only further drift ends the scan");
  scan->add_option("--preview", o.preview, "Scene file: pictures of it are made after 5, 50 and 100 % of the cells");
  scan->add_option("--pictures", o.pictures, "Folder for these pictures (default: beside the dataset)");
  scan->add_option("--size", o.size, "Size of these pictures")->check(picture_size())->capture_default_str();
  scan->add_option("--exposure", o.exposure, "Exposure of their tone curve")->check(positive())->capture_default_str();
  scan->add_option(
      "--record", o.record,
      "Folder to keep every frame in, and a bench.json that plays them back without camera and stage; with "
      "--resume, the one that the scan began");
  scan->add_flag("--json", o.json, "Print the summary as one JSON object");
}

void add_rehearse(CLI::App& app, RehearseOptions& o) {
  CLI::App* rehearse = app.add_subcommand("rehearse", "Try a scan in small: corners, reference cell, a test shot");
  add_bench(rehearse, o.bench);
  rehearse->add_option("--plan", o.plan, "Plan file")->required();
  rehearse->add_option("--out", o.out, "Where the scan will be stored: is there room?")->capture_default_str();
  rehearse->add_option("--cell", o.cell, "Row and column of the test shot (default: the reference cell)")
      ->expected(2)
      ->check(CLI::NonNegativeNumber);
  rehearse->add_flag("--json", o.json, "Print the summary as one JSON object");
}

std::string described_methods() {
  std::string text = "How the light is computed:";
  for (const MethodInfo& each : methods()) {
    text += "\n" + std::string(each.name) + ": " + std::string(each.what);
    if (each.samples > 0) text += " (usual --samples: " + std::to_string(static_cast<int>(each.samples)) + ")";
  }
  return text + "\n";
}

std::string described_visibilities() {
  std::string text = "What casts shadows:";
  for (const VisibilityInfo& each : visibilities())
    text += "\n" + std::string(each.name) + ": " + std::string(each.what);
  return text + "\n";
}

/// What was given for a method that has no use for it, or more than it takes: wrong use.
void check_use(const CLI::App& app, const std::string& method, double samples) {
  const MethodInfo& chosen = info(method_from_string(method).value_or(Method::closed_form));
  if (app.count("--lod") > 0 && chosen.cost != MethodCost::pixels_per_support)
    throw CLI::ValidationError("--lod", "is of closed-form alone; " + method + " has no level of detail");
  for (const char* option : {"--samples", "--seed"})
    if (app.count(option) > 0 && chosen.samples == 0)
      throw CLI::ValidationError(option, method + " takes none; leave it out");
  if (app.count("--filter") > 0 && !averages_light(chosen.method))
    throw CLI::ValidationError("--filter", method + " averages no light; leave it out");
  if (app.count("--spots") > 0 && chosen.method != Method::shift_invariant)
    throw CLI::ValidationError("--spots", "is of shift-invariant alone; leave it out");
  if (chosen.cost == MethodCost::lights && samples > most_lights)
    throw CLI::ValidationError("--samples", method + " takes 4 million lights at most");
}

/// Of what casts shadows.
void check_shadows(const CLI::App& app, const RenderOptions& o) {
  const Method method = method_from_string(o.method).value_or(Method::closed_form);
  if (app.count("--shadows") > 0 && has_own_shadows(method) && o.shadows != to_string(Visibility::none))
    throw CLI::ValidationError("--shadows", o.method + " has a depth map of each cell; give none, or leave it out");
}

template <class Options>
void add_method(CLI::App& app, Options& o) {
  app.add_option("--method", o.method, described_methods())->check(method_name())->capture_default_str();
  app.add_option(
         "--lod", o.lod,
         "closed-form: level of detail, pixels of an image per support of a cell and axis, 1 or more; 0 is exact")
      ->check(level_of_detail())
      ->capture_default_str();
  app.add_option("--samples", o.samples,
                 "Samples for each receiver, up to 10 million; precomputed-lights: lights in all, up to 4 million "
                 "(default: the method's usual)")
      ->check(sample_count());
  app.add_option("--filter", o.filter,
                 "filtered-brdf, mis: each sample of a lobe stands for a footprint, averaged (on: less noise, biased), "
                 "or for a ray (off: unbiased)")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  app.add_option("--spots", o.spots,
                 "shift-invariant: a cell's image averaged as its basis weighs it (weighted), or by one look-up of a "
                 "texture, as the window has it (textured: faster, biased)")
      ->check(CLI::IsMember({"weighted", "textured"}))
      ->capture_default_str();
  app.add_option("--seed", o.seed, "Seed of the samples")->check(seed_number())->capture_default_str();
  app.final_callback([&app, &o] {
    check_use(app, o.method, o.samples);
    if constexpr (std::is_same_v<Options, RenderOptions>) check_shadows(app, o);
  });
}

void add_render(CLI::App& app, RenderOptions& o) {
  CLI::App* render = app.add_subcommand("render", "Render one picture of a scene lit by a luminaire");
  render->add_option("--luminaire", o.luminaire, "Dataset folder")->required();
  render->add_option("--scene", o.scene, "Scene file")->required();
  add_method(*render, o);
  render->add_option("--shadows", o.shadows, described_visibilities())->check(visibility_name())->capture_default_str();
  render
      ->add_option(
          "--environment", o.environment,
          "Light of the scene's environment, which surfaces reflect and which is not shown behind them: on or off "
          "(default: on where the scene names one)")
      ->check(CLI::IsMember({"on", "off"}));
  render->add_option("--size", o.size, "Picture size")->check(picture_size())->capture_default_str();
  render->add_option("--exposure", o.exposure, "Exposure of the tone curve (PNG)")
      ->check(positive())
      ->capture_default_str();
  render->add_option("--white", o.white, "Radiance that the tone curve takes as average; 0: the picture's own")
      ->check(not_below_zero());
  render->add_option("--out", o.out, "Linear radiance (EXR) or tone-mapped (PNG); a file of that name is replaced")
      ->check(picture_file())
      ->required();
  render->add_flag("--json", o.json, "Print the figures as one JSON object");
}

void add_probe(CLI::App& app, ProbeOptions& o) {
  CLI::App* probe = app.add_subcommand("probe", "Irradiance at points");
  probe->add_option("--luminaire", o.luminaire, "Dataset folder")->required();
  probe->add_option("--points", o.points, "CSV with columns x_mm,y_mm,z_mm,nx,ny,nz in the luminaire frame")
      ->required();
  add_method(*probe, o);
  probe
      ->add_option("--device", o.device,
                   "host (double precision) or opencl; of shift-invariant the kernel is one of OpenGL")
      ->check(CLI::IsMember({"host", "opencl"}))
      ->capture_default_str();
  probe
      ->add_option(
          "--out", o.out,
          "CSV to write: the same points with a column E_<channel> each, in W/m^2 or lx as the dataset has it; "
          "a file of that name is replaced")
      ->required();
  probe->add_flag(
      "--stated-error", o.stated_error,
      "A column stated_error_<channel> too, same unit: how far the method may be off the exact sum over this "
      "dataset, of samplers one standard deviation (and the known bias), of the others a bound; not how far "
      "the dataset is off the lamp");
  probe->add_flag("--json", o.json, "Print the figures as one JSON object");
}

void add_study(CLI::App& app, StudyOptions& o) {
  CLI::App* study =
      app.add_subcommand("study", "Set every method's error against its time, and try where methods fail");
  study->add_option("--luminaire", o.luminaires,
                    "Dataset folder, or bike, car1, car2, which are built in; may be given more than once (default: "
                    "all three)");
  study->add_option("--scene", o.scene, "Scene file")->required();
  study->add_option("--out", o.out, "Folder for study.json, its tables as CSV, and the chart as SVG and PNG")
      ->required();
  study->add_option("--cache", o.cache, "Folder in which references are kept, else $XDG_CACHE_HOME/lumifield");
  study->add_flag("--quick", o.quick, "Few points of each method: minutes instead of up to an hour");
  study->add_flag("--ladders-only", o.ladders_only,
                  "Errors against time alone: no cases in which methods fail, no figures");
  study->add_flag("--force", o.force, "Replace the study that is in the folder");
  study->add_flag("--json", o.json, "Print the summary as one JSON object");
}

void add_check(CLI::App& app, CheckOptions& o) {
  CLI::App* check =
      app.add_subcommand("check", "Check datasets (every file, every number), benches, plans, scenes and studies");
  check->add_option("paths", o.paths, "Dataset folders and JSON files")->required();
  check->add_flag("--json", o.json, "Print the findings as one JSON object");
}

void add_devices(CLI::App& app, DevicesOptions& o) {
  CLI::App* devices =
      app.add_subcommand("devices", "List cameras, stages, OpenCL and OpenGL; for each not usable, why");
  devices->add_option("--bench", o.bench, "Bench file whose camera and stage are tried too")
      ->envname("LUMIFIELD_BENCH");
  devices->add_option("--frames", o.frames, "Take so many frames with the bench's camera, and tell of broken ones")
      ->check(CLI::Range(0, 100'000));
  devices->add_option("--exposure", o.exposure_s, "Of those frames, s");
  devices->add_option("--stage", o.stage_path, "Serial port to try as well");
  devices->add_flag("--json", o.json, "Print the list as one JSON object");
}

void add_window(CLI::App& app, WindowOptions& o) {
  app.add_option("luminaire", o.luminaire, "Dataset folder to open in the window")->check(dataset_folder());
  app.add_option("--bench", o.bench, "Bench file to watch and to scan with")->envname("LUMIFIELD_BENCH");
  CLI::Option* plan = app.add_option("--plan", o.plan, "Plan of the scan");
  CLI::Option* out = app.add_option("--out", o.out, "Dataset folder of the scan; one that is there is gone on with");
  plan->needs(out);
  out->needs(plan);
  app.add_option("--scene", o.scene, "Scene that is lit");
  app.add_flag("--start", o.start, "The scan begins by itself")->needs(plan);
}

int run(int argc, char** argv, RunWindow window, WriteStudyChart write_chart) {
  CLI::App app("Lumifield scans lamps into light field luminaires and shows how they light a scene.", "lumifield");
  app.set_version_flag("--version", "lumifield " LUMIFIELD_VERSION);
  app.require_subcommand(0, 1);
  app.description(
      app.get_description() +
      "\nWithout a sub-command the window opens: lumifield [NAME.lumi] [--bench B --plan P --out D [--start]].");
  WindowOptions window_options;
  add_window(app, window_options);
  ScanOptions scan;
  RehearseOptions rehearse;
  RenderOptions render;
  ProbeOptions probe;
  StudyOptions study;
  CheckOptions check;
  DevicesOptions devices;
  add_scan(app, scan);
  add_rehearse(app, rehearse);
  add_render(app, render);
  add_probe(app, probe);
  add_study(app, study);
  add_check(app, check);
  add_devices(app, devices);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? exit_done : exit_wrong_use;
  }
  if (app.got_subcommand("scan")) return run_scan(scan);
  if (app.got_subcommand("rehearse")) return run_rehearse(rehearse);
  if (app.got_subcommand("render")) return run_render(render);
  if (app.got_subcommand("probe")) return run_probe(probe);
  if (app.got_subcommand("study")) return run_study_command(study, write_chart);
  if (app.got_subcommand("check")) return run_check(check);
  if (app.got_subcommand("devices")) return run_devices(devices);
  if (window_options.start && window_options.bench.empty()) {
    std::fputs("lumifield: --start needs a bench: give --bench or set LUMIFIELD_BENCH\n", stderr);
    return exit_wrong_use;
  }
  return window(argc, argv, window_options);
}

}  // namespace

int run_command_line(int argc, char** argv, RunWindow window, WriteStudyChart write_chart) {
  try {
    return run(argc, argv, window, write_chart);
  } catch (const std::bad_alloc&) {
    return report_error({"not enough memory for this", "", "use smaller images or a smaller picture"}, false);
  } catch (const std::exception& error) {
    return report_error({std::string("unexpected failure: ") + error.what(), "", "please report it"}, false);
  }
}

}  // namespace lumifield
