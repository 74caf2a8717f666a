#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/cli/commands.h"
#include "app/cli/print_result.h"
#include "luminaire/dataset.h"
#include "luminaire/scene.h"
#include "renderer/renderer.h"

namespace lumifield {

namespace {

Status write_picture(const Picture& picture, const RenderOptions& options) {
  const std::filesystem::path out = options.out;
  if (out.extension() == ".exr") return write_exr(picture, out);
  return write_png(tone_map(picture, {options.exposure, options.white}), out);
}

Result<nlohmann::ordered_json> render(const RenderOptions& options) {
  const auto size = parse_size(options.size);
  if (!size) return tl::unexpected(size.error());
  auto scene = read_scene(options.scene);
  if (!scene) return tl::unexpected(scene.error());
  if (options.environment == "on" && !scene->environment)
    return fail("it names no environment", options.scene, "name one (\"environment\"), or leave --environment out");
  if (options.environment == "off") scene->environment.reset();  // so that it is not read
  auto dataset = read_dataset(options.luminaire);
  if (!dataset) return tl::unexpected(dataset.error());
  print_notes(dataset->index.notes);

  auto renderer = Renderer::create(*scene, size->first, size->second);
  if (!renderer) return tl::unexpected(renderer.error());
  print_notes((*renderer)->info().notes);
  if (Status viewed = (*renderer)->set_view(scene->camera, size->first, size->second, options.lod); !viewed)
    return tl::unexpected(viewed.error());
  const MethodSettings settings = method_settings(options);
  const Visibility shadows = visibility_from_string(options.shadows).value_or(Visibility::tile);
  const auto start = std::chrono::steady_clock::now();
  if (Status set = (*renderer)->set_visibility(shadows); !set) return tl::unexpected(set.error());
  if (Status set = (*renderer)->set_method(settings); !set) return tl::unexpected(set.error());
  if (Status set = (*renderer)->set_luminaire(dataset->light_field.geometry()); !set)
    return tl::unexpected(set.error());
  if (Status added = (*renderer)->add_all(dataset->light_field); !added) return tl::unexpected(added.error());
  auto picture = (*renderer)->picture();
  if (!picture) return tl::unexpected(picture.error());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
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
                                        {"time_s", seconds},
                                        {"kernel_s", (*renderer)->last_kernel_s()},
                                        {"average_luminance", average_luminance(*picture)},
                                        {"left_out", picture->note},
                                        {"opengl", info.opengl},
                                        {"opencl", info.opencl}});
  return summary;
}

}  // namespace

int run_render(const RenderOptions& options) {
  return print_result(render(options), options.json, [](const nlohmann::ordered_json& r) {
    char figures[64];
    std::snprintf(figures, sizeof figures, "%d of %d cells, %.2f s", r["cells"].get<int>(), r["cells_total"].get<int>(),
                  r["time_s"].get<double>());
    return r["out"].get<std::string>() + ": " + figures + "; left out: " + r["left_out"].get<std::string>();
  });
}

}  // namespace lumifield
