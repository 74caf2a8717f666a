#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/cli/commands.h"
#include "app/cli/noted_files.h"
#include "app/cli/piecewise.h"
#include "app/cli/print_result.h"
#include "app/cli/stop_signal.h"
#include "renderer/renderer.h"

namespace lumifield {

namespace {

using Clock = std::chrono::steady_clock;

Status write_picture(const Picture& picture, const RenderOptions& options) {
  const std::filesystem::path out = options.out;
  if (out.extension() == ".exr") return write_exr(picture, out);
  return write_png(tone_map(picture, {options.exposure, options.white}), out);
}

/// All of the light that is kept. The kernels' time, s.
Result<double> sum_light(Renderer& renderer, bool additive) {
  Piecewise pieces("light");
  double kernel_s = 0;
  while (renderer.waiting() > 0) {
    if (Status summed = renderer.sum_some(piece_s); !summed) return tl::unexpected(summed.error());
    kernel_s = renderer.last_kernel_s() + (additive ? kernel_s : 0);
    if (Status done = pieces.done(renderer.share_summed()); !done) return tl::unexpected(done.error());
  }
  return kernel_s;
}

/// Of the environment where it is on.
Status surround(Renderer& renderer) {
  Piecewise pieces("environment");
  while (!renderer.surround(piece_s))
    if (Status done = pieces.done(renderer.share_surrounded()); !done) return done;
  return {};
}

Result<Scene> read_lit_scene(const RenderOptions& options) {
  auto scene = read_noted_scene(options.scene);
  if (!scene) return scene;
  if (options.environment == "on" && !scene->environment)
    return fail("it names no environment", options.scene, "name one (\"environment\"), or leave --environment out");
  if (options.environment == "off") scene->environment.reset();  // so that it is not read
  return scene;
}

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

Result<nlohmann::ordered_json> render(const RenderOptions& options) {
  const Clock::time_point begun = Clock::now();
  const auto size = parse_size(options.size);
  if (!size) return tl::unexpected(size.error());
  if (Status writable = check_writable(options.out); !writable) return tl::unexpected(writable.error());
  stop_on_signals();
  auto scene = read_lit_scene(options);
  if (!scene) return tl::unexpected(scene.error());
  auto dataset = read_noted_dataset(options.luminaire);
  if (!dataset) return tl::unexpected(dataset.error());

  auto renderer = Renderer::create(*scene, size->first, size->second);
  if (!renderer) return tl::unexpected(renderer.error());
  for (const std::string& note : (*renderer)->info().notes) print_note(note);
  if (Status viewed = (*renderer)->set_view(scene->camera, size->first, size->second, options.lod); !viewed)
    return tl::unexpected(viewed.error());
  const MethodSettings settings = method_settings(options);
  const Visibility shadows = visibility_from_string(options.shadows).value_or(Visibility::tile);
  if (Status set = (*renderer)->set_visibility(shadows); !set) return tl::unexpected(set.error());
  if (Status set = (*renderer)->set_method(settings); !set) return tl::unexpected(set.error());
  if (Status set = (*renderer)->set_luminaire(dataset->light_field.geometry()); !set)
    return tl::unexpected(set.error());
  if (Status kept = (*renderer)->keep_all(dataset->light_field); !kept) return tl::unexpected(kept.error());
  const Clock::time_point start = Clock::now();
  const auto kernel_s = sum_light(**renderer, is_additive(settings.method));
  if (!kernel_s) return tl::unexpected(kernel_s.error());
  if (Status surrounded = surround(**renderer); !surrounded) return tl::unexpected(surrounded.error());
  auto picture = (*renderer)->picture();
  if (!picture) return tl::unexpected(picture.error());
  const double seconds = seconds_since(start);
  if (Status written = write_picture(*picture, options); !written) return tl::unexpected(written.error());

  const Coverage coverage = dataset->light_field.coverage();
  const RendererInfo info = (*renderer)->info();
  nlohmann::ordered_json summary{{"out", options.out}};
  summary.update(method_summary(settings));
  summary.update(nlohmann::ordered_json{{"shadows", shadows_of(settings.method, shadows)},
                                        {"environment", (*renderer)->environment() ? "on" : "off"},
                                        {"width_px", size->first},
                                        {"height_px", size->second},
                                        {"cells", coverage.measured},
                                        {"cells_total", coverage.total},
                                        {"total_s", seconds_since(begun)},
                                        {"time_s", seconds},
                                        {"kernel_s", *kernel_s},
                                        {"average_luminance", average_luminance(*picture)},
                                        {"left_out", picture->note},
                                        {"opengl", info.opengl},
                                        {"opencl", info.opencl}});
  return summary;
}

std::string in_words(const nlohmann::ordered_json& r) {
  const int cells = r["cells"].get<int>(), total = r["cells_total"].get<int>();
  char times[64];
  std::snprintf(times, sizeof times, "%.2f s, of it %.2f s light", r["total_s"].get<double>(),
                r["time_s"].get<double>());
  return r["out"].get<std::string>() + ": " + method_words(r) + ", shadows " + r["shadows"].get<std::string>() + ", " +
         std::to_string(cells) + " of " + std::to_string(total) + " cells" +
         (cells < total ? " (the others' light is missing)" : "") + ", " + times +
         "; left out: " + r["left_out"].get<std::string>();
}

}  // namespace

int run_render(const RenderOptions& options) { return print_result(render(options), options.json, in_words); }

}  // namespace lumifield
