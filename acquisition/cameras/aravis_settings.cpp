#include "acquisition/cameras/aravis_settings.h"

#include <algorithm>
#include <arv.h>
#include <cmath>

#include "acquisition/cameras/aravis_automatics.h"
#include "acquisition/cameras/aravis_gain.h"

namespace lumifield {
namespace {

constexpr int longest_side_px = 1 << 16;
constexpr double us_per_s = 1e6;

tl::unexpected<Error> error(const CameraSettings& settings, std::string what, std::string remedy) {
  return fail(std::move(what), "camera " + settings.address, std::move(remedy));
}

Status check_pixel_format(ArvCamera* camera, const CameraSettings& settings) {
  const std::string& wanted = settings.pixel_format;
  const Result<std::vector<std::string>> offered = usable_pixel_formats(camera, settings);
  if (!offered) return tl::unexpected(offered.error());
  std::string usable;
  for (const std::string& name : *offered) usable.append(usable.empty() ? "" : ", ").append(name);
  const std::string remedy = usable.empty() ? "use a camera that gives its photosites" : "choose one of " + usable;
  for (const char* family : {"YUV", "YCbCr"})
    if (wanted.starts_with(family))
      return error(settings, "gives in \"" + wanted + "\" sums of colours for screens: no measurement", remedy);
  if (std::ranges::find(*offered, wanted) == offered->end())
    return error(settings, "does not offer the pixel format \"" + wanted + "\"", remedy);
  return {};
}

std::string binning_of(int side) { return "a binning of " + std::to_string(side) + "x" + std::to_string(side); }

/// Whether there is any.
Result<bool> check_binning(ArvCamera* camera, const CameraSettings& settings) {
  GFault fault;
  const bool is_there = arv_camera_is_binning_available(camera, fault.out());
  if (fault) return refused(settings, "a question for its binning", fault);
  if (!is_there && settings.binning != 1)
    return error(settings, "has no binning to set", "set \"binning\": 1 in the bench file");
  if (!is_there) return false;
  gint low_x = 0, high_x = 0, low_y = 0, high_y = 0;
  arv_camera_get_x_binning_bounds(camera, &low_x, &high_x, fault.out());
  arv_camera_get_y_binning_bounds(camera, &low_y, &high_y, fault.out());
  const int low = std::max(low_x, low_y), high = std::min(high_x, high_y);
  if (!fault && (settings.binning < low || settings.binning > high))
    return error(settings, binning_of(settings.binning) + " is out of its range",
                 "choose one from " + std::to_string(low) + " to " + std::to_string(high));
  if (fault) return refused(settings, "a question for its binning", fault);
  return true;
}

struct Applying {
  ArvCamera* camera;
  const CameraSettings& settings;
  AppliedSettings applied;

  Status mirrors() { return switch_mirrors_off(camera, settings); }
  Status pixel_format();
  Status binning();
  Status full_region();
  Status automatics() { return switch_automatics_off(camera, settings); }
  Status gain();
  Status trigger();

  tl::unexpected<Error> error(std::string what, std::string remedy) const {
    return lumifield::error(settings, std::move(what), std::move(remedy));
  }
};

Status Applying::pixel_format() {
  const std::string& wanted = settings.pixel_format;
  if (Status offered = check_pixel_format(camera, settings); !offered) return offered;
  GFault fault;
  arv_camera_set_pixel_format_from_string(camera, wanted.c_str(), fault.out());
  const std::string taken = text_or_empty(arv_camera_get_pixel_format_as_string(camera, fault.out()));
  applied.format = arv_camera_get_pixel_format(camera, fault.out());
  if (fault) return refused(settings, "the pixel format " + wanted, fault);
  if (taken != wanted)
    return error("took the pixel format " + taken + " for " + wanted, "choose another one that it offers");
  applied.layout = *pixel_layout(wanted);
  return {};
}

Status Applying::binning() {
  const Result<bool> is_there = check_binning(camera, settings);
  if (!is_there) return tl::unexpected(is_there.error());
  if (!*is_there) return {};
  GFault fault;
  const int wanted = settings.binning;
  gint columns = 0, rows = 0;
  GFault ignored;  // a camera that does not take it may have it already: what is read back counts
  arv_camera_set_binning(camera, wanted, wanted, ignored.out());
  arv_camera_get_binning(camera, &columns, &rows, fault.out());
  if (fault) return refused(settings, binning_of(wanted), fault);
  if (columns != wanted || rows != wanted)
    return error(
        "took a binning of " + std::to_string(columns) + "x" + std::to_string(rows) + " for " + binning_of(wanted),
        "choose one that it offers");
  return {};
}

Status Applying::full_region() {
  GFault fault;
  if (arv_camera_is_region_offset_available(camera, fault.out())) {
    arv_camera_set_integer(camera, "OffsetX", 0, fault.out());
    arv_camera_set_integer(camera, "OffsetY", 0, fault.out());
  }
  gint smallest, width = 0, height = 0, x = 0, y = 0;
  arv_camera_get_width_bounds(camera, &smallest, &width, fault.out());
  arv_camera_get_height_bounds(camera, &smallest, &height, fault.out());
  arv_camera_set_region(camera, 0, 0, width, height, fault.out());
  arv_camera_get_region(camera, &x, &y, &applied.width_px, &applied.height_px, fault.out());
  if (fault) return refused(settings, "its full region", fault);
  if (x != 0 || y != 0 || applied.width_px != width || applied.height_px != height || width <= 0 || height <= 0 ||
      width > longest_side_px || height > longest_side_px)
    return error("took the region " + std::to_string(applied.width_px) + "x" + std::to_string(applied.height_px) +
                     " for " + std::to_string(width) + "x" + std::to_string(height),
                 "set binning and region back in the camera");
  return {};
}

Status Applying::gain() {
  const Result<double> gain_db = set_aravis_gain(camera, settings);
  if (!gain_db) return tl::unexpected(gain_db.error());
  applied.gain_db = *gain_db;
  return {};
}

Status Applying::trigger() {
  GFault fault;
  if (arv_camera_is_feature_available(camera, "AcquisitionFrameRateEnable", fault.out()))
    arv_camera_set_boolean(camera, "AcquisitionFrameRateEnable", FALSE, fault.out());  // it would bound the exposure
  arv_camera_set_acquisition_mode(camera, ARV_ACQUISITION_MODE_CONTINUOUS, fault.out());
  arv_camera_set_trigger(camera, "Software", fault.out());
  const std::string source = text_or_empty(arv_camera_get_trigger_source(camera, fault.out()));
  double shortest_us = 0, longest_us = 0;
  arv_camera_get_exposure_time_bounds(camera, &shortest_us, &longest_us, fault.out());
  if (fault) return refused(settings, "a software trigger", fault);
  if (source != "Software") return error("took the trigger " + source + " for Software", "use another camera");
  applied.shortest_s = shortest_us / us_per_s;
  applied.longest_s = longest_us / us_per_s;
  return {};
}

}  // namespace

GFault::~GFault() { g_clear_error(&error_); }

std::string GFault::text() const { return error_ == nullptr ? "" : error_->message; }

std::vector<std::string> take_names(const char** names, unsigned count) {
  std::vector<std::string> taken;
  for (unsigned i = 0; names != nullptr && i < count; ++i) taken.emplace_back(names[i]);
  g_free(names);
  return taken;
}

Result<std::vector<std::string>> usable_pixel_formats(ArvCamera* camera, const CameraSettings& settings) {
  GFault fault;
  guint count = 0;
  const char** const names = arv_camera_dup_available_pixel_formats_as_strings(camera, &count, fault.out());
  std::vector<std::string> usable = take_names(names, count);
  if (fault) return refused(settings, "a question for its pixel formats", fault);
  std::erase_if(usable, [](const std::string& name) { return !pixel_layout(name); });
  return usable;
}

Status check_offered(ArvCamera* camera, const CameraSettings& settings) {
  if (Status offered = check_pixel_format(camera, settings); !offered) return offered;
  const Result<bool> bins = check_binning(camera, settings);
  return bins ? Status() : tl::unexpected(bins.error());
}

Result<AppliedSettings> apply_settings(ArvCamera* camera, const CameraSettings& settings) {
  Applying applying{camera, settings, {}};
  using Step = Status (Applying::*)();
  for (const Step step : {&Applying::mirrors, &Applying::pixel_format, &Applying::binning, &Applying::full_region,
                          &Applying::automatics, &Applying::gain, &Applying::trigger})
    if (Status done = (applying.*step)(); !done) return tl::unexpected(done.error());
  return applying.applied;
}

tl::unexpected<Error> refused(const CameraSettings& settings, const std::string& what, const GFault& fault) {
  return fail("does not take " + what + " (" + fault.text() + ")", "camera " + settings.address,
              "check the bench file and the camera's manual");
}

std::string text_or_empty(const char* text) { return text == nullptr ? "" : text; }

}  // namespace lumifield
