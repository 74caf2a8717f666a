#include "acquisition/cameras/aravis_automatics.h"

#include <arv.h>
#include <cmath>

#include "acquisition/cameras/aravis_settings.h"

namespace lumifield {
namespace {

struct Automatic {
  const char* feature;
  const char* what;
};
constexpr Automatic choices[] = {{"ExposureAuto", "its exposure by itself"},
                                 {"GainAuto", "its gain by itself"},
                                 {"BlackLevelAuto", "its black level by itself"},
                                 {"BalanceWhiteAuto", "its white balance by itself"}};
constexpr Automatic switches[] = {{"LUTEnable", "values by a look-up table"},
                                  {"ColorTransformationEnable", "colours by a matrix"}};
constexpr double gamma_tolerance = 1e-3;

Result<bool> has(ArvCamera* camera, const CameraSettings& settings, const char* feature) {
  GFault fault;
  const bool is_there = arv_camera_is_feature_available(camera, feature, fault.out());
  if (fault) return refused(settings, std::string("a question for ") + feature, fault);
  return is_there;
}

tl::unexpected<Error> stays_on(const CameraSettings& settings, const Automatic& automatic, const std::string& kept) {
  return fail("changes " + std::string(automatic.what) + ": " + automatic.feature + " stays " + kept,
              "camera " + settings.address, "switch it off with the maker's program, or use another camera");
}

/// A camera that does not take it may have it off already: what is read back counts.
Status check_choice(ArvCamera* camera, const CameraSettings& settings, const Automatic& automatic) {
  const Result<bool> is_there = has(camera, settings, automatic.feature);
  if (!is_there || !*is_there) return is_there ? Status{} : tl::unexpected(is_there.error());
  GFault ignored, fault;
  arv_camera_set_string(camera, automatic.feature, "Off", ignored.out());
  const std::string kept = text_or_empty(arv_camera_get_string(camera, automatic.feature, fault.out()));
  if (fault) return refused(settings, std::string("a question for ") + automatic.feature, fault);
  return kept == "Off" ? Status{} : stays_on(settings, automatic, kept);
}

/// Whether it is on after it was switched off.
Result<bool> stays_on(ArvCamera* camera, const CameraSettings& settings, const char* feature) {
  GFault ignored, fault;
  arv_camera_set_boolean(camera, feature, FALSE, ignored.out());
  const bool is_on = arv_camera_get_boolean(camera, feature, fault.out());
  if (fault) return refused(settings, std::string("a question for ") + feature, fault);
  return is_on;
}

Status check_switch(ArvCamera* camera, const CameraSettings& settings, const Automatic& automatic) {
  const Result<bool> is_there = has(camera, settings, automatic.feature);
  if (!is_there || !*is_there) return is_there ? Status{} : tl::unexpected(is_there.error());
  const Result<bool> is_on = stays_on(camera, settings, automatic.feature);
  if (!is_on) return tl::unexpected(is_on.error());
  return *is_on ? stays_on(settings, automatic, "on") : Status{};
}

Status check_gamma(ArvCamera* camera, const CameraSettings& settings) {
  const Result<bool> has_switch = has(camera, settings, "GammaEnable");
  if (!has_switch) return tl::unexpected(has_switch.error());
  const Result<bool> has_gamma = has(camera, settings, "Gamma");
  if (!has_gamma) return tl::unexpected(has_gamma.error());
  if (*has_switch) {
    const Result<bool> is_on = stays_on(camera, settings, "GammaEnable");
    if (!is_on) return tl::unexpected(is_on.error());
    if (!*is_on) return {};
    if (!*has_gamma) return stays_on(settings, {"GammaEnable", "values by a gamma"}, "on");
  }
  if (!*has_gamma) return {};
  GFault ignored, fault;
  arv_camera_set_float(camera, "Gamma", 1, ignored.out());
  const double kept = arv_camera_get_float(camera, "Gamma", fault.out());
  if (fault) return refused(settings, "a question for Gamma", fault);
  if (std::abs(kept - 1) <= gamma_tolerance) return {};
  return stays_on(settings, {"Gamma", "values by a gamma"}, number(kept));
}

}  // namespace

Status switch_automatics_off(ArvCamera* camera, const CameraSettings& settings) {
  for (const Automatic& each : choices)
    if (Status off = check_choice(camera, settings, each); !off) return off;
  for (const Automatic& each : switches)
    if (Status off = check_switch(camera, settings, each); !off) return off;
  return check_gamma(camera, settings);
}

}  // namespace lumifield
