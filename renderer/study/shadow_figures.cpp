#include "renderer/study/shadow_figures.h"

#include <algorithm>
#include <cmath>

#include "renderer/study/lab.h"
#include "renderer/study/ladder.h"
#include "renderer/study/relative_rmse.h"

namespace lumifield {

namespace {

constexpr int width = 160, height = 120;
constexpr double piece_s = 0.5;

/// Goes on piece by piece, so that it can be stopped. `told` is asked between two pieces.
Result<std::vector<double>> evaluate(const LightField& light_field, const StudyFrame& frame, Method which,
                                     const std::function<bool()>& told) {
  const auto method = make_device_method(light_field.geometry(), {.method = which});
  if (!method) return tl::unexpected(method.error());
  if (const Status set = (*method)->set_cells(light_field); !set) return tl::unexpected(set.error());
  if (const Status set = (*method)->set_receivers(frame.receivers, frame.appearance); !set)
    return tl::unexpected(set.error());
  for (bool all = false; !all;) {
    if (!told()) return study_stopped();
    const auto done = (*method)->evaluate(piece_s);
    if (!done) return tl::unexpected(done.error());
    all = *done;
  }
  std::vector<double> irradiance;
  if (const Status read = (*method)->read(irradiance); !read) return tl::unexpected(read.error());
  return irradiance;
}

std::string words(Visibility visibility) {
  return visibility == Visibility::rays
             ? "rays to the tiles' centres"
             : std::string(to_string(visibility)) + ": " + std::string(info(visibility).what);
}

}  // namespace

Result<std::vector<FigureRow>> shadow_figures(StudyCamera& camera, const StudyLuminaire& luminaire,
                                              const StudyProgress& progress) {
  const LightField& light_field = luminaire.light_field;
  const std::size_t channels = light_field.geometry().channels.size();
  const auto told = [&] { return progress(0, luminaire.name + ", shadows"); };
  const auto frame_with = [&](Visibility visibility) {
    return camera.frame(width, height, light_field, {.visibility = visibility});
  };
  const auto by_rays = frame_with(Visibility::rays);
  if (!by_rays) return tl::unexpected(by_rays.error());
  const auto truth = evaluate(light_field, *by_rays, Method::reference, told);
  if (!truth) return tl::unexpected(truth.error());
  const Picture picture = by_rays->picture({*truth, {}}, channels);
  const double white = average_luminance(picture);
  if (!(white > 0)) return fail("the luminaire lights nothing that is seen", luminaire.name, "turn it");
  const Picture8 reference = tone_map(picture, {1, white});

  std::vector<FigureRow> rows;
  for (const VisibilityInfo& each : visibilities()) {
    const auto frame = frame_with(each.visibility);
    if (!frame) return tl::unexpected(frame.error());
    const auto light = evaluate(light_field, *frame, Method::closed_form, told);
    if (!light) return tl::unexpected(light.error());
    RelativeRmse error;
    for (std::size_t k = 0; k < truth->size(); ++k) error.add((*light)[k], (*truth)[k]);
    const bool maps = each.visibility == Visibility::tile || each.visibility == Visibility::published;
    const Picture8 mapped = tone_map(frame->picture({*light, {}}, channels), {1, white});
    const auto add = [&](const char* quantity, double ours, double paper) {
      rows.push_back({"Fig. 7", luminaire.name, words(each.visibility), quantity, ours, paper});
    };
    add("mean Lab ΔE", mean_lab_delta_e(mapped, reference), maps ? 1.2 : std::nan(""));
    add("relative RMSE of irradiance, %", 100 * error.value(), std::nan(""));
  }
  return rows;
}

}  // namespace lumifield
