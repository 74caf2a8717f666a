#include "acquisition/cameras/aravis_automatics.h"

#include <arv.h>
#include <cmath>

#include "acquisition/cameras/aravis_selectors.h"
#include "acquisition/cameras/aravis_settings.h"
#include "luminaire/wording.h"

namespace lumifield {
namespace {

struct Automatic {
  const char* feature;
  const char* harm;
  const char* selector = nullptr;
  const char* wanted = "Off";
};
constexpr const char* by_preset = "changes colours and response as for a kind of light";
constexpr const char* to_screens = "bends its response as for screens";
constexpr Automatic choices[] = {{"ExposureMode", "exposes for another time than it is told", nullptr, "Timed"},
                                 {"ExposureAuto", "changes its exposure by itself"},
                                 {"GainAuto", "changes its gain by itself", "GainSelector"},
                                 {"BlackLevelAuto", "changes its black level by itself", "BlackLevelSelector"},
                                 {"BalanceWhiteAuto", "changes its white balance by itself"},
                                 {"LightSourcePreset", by_preset},
                                 {"BslLightSourcePreset", by_preset},
                                 {"ColorSpace", to_screens, nullptr, "RGB"},
                                 {"BslColorSpaceMode", to_screens, nullptr, "RGB"},
                                 {"BslColorSpace", to_screens}};
constexpr Automatic switches[] = {
    {"LUTEnable", "changes values by a look-up table", "LUTSelector"},
    {"ColorTransformationEnable", "changes colours by a matrix", "ColorTransformationSelector"},
    {"SaturationEnable", "changes colours by their saturation"},
    {"HueEnable", "turns colours by a hue"},
    {"SharpeningEnable", "mixes neighbouring pixels to sharpen them"}};
constexpr Automatic balance{"BalanceRatio", "changes values by a factor of their colour", "BalanceRatioSelector", "1"};
constexpr Automatic gamma_switch{"GammaEnable", "changes values by a gamma"};
constexpr Automatic gamma_power{"Gamma", "changes values by a gamma", nullptr, "1"};
constexpr Automatic mirrors[] = {{"ReverseX", "sends its frames mirrored, left to right"},
                                 {"ReverseY", "sends its frames mirrored, top to bottom"}};
constexpr double one_tolerance = 1e-3;

/// At one place, where it is there. A camera that does not take it may have it already: what is read back counts.
using Check = Status (*)(ArvCamera* camera, const CameraSettings& settings, const Automatic& automatic,
                         const std::string& place);

tl::unexpected<Error> stays(const CameraSettings& settings, const Automatic& automatic, const std::string& kept,
                            const std::string& place) {
  const std::string wanted = automatic.wanted;
  return fail(
      std::string(automatic.harm) + ": " + automatic.feature + " stays " + kept + place, "camera " + settings.address,
      (wanted == "Off" ? "switch it off" : "set it to " + wanted) + " with the maker's program, or use another camera");
}

tl::unexpected<Error> unanswered(const CameraSettings& settings, const Automatic& automatic, const GFault& fault) {
  return refused(settings, std::string("a question for ") + automatic.feature, fault);
}

Status check_choice(ArvCamera* camera, const CameraSettings& settings, const Automatic& automatic,
                    const std::string& place) {
  GFault ignored, fault;
  arv_camera_set_string(camera, automatic.feature, automatic.wanted, ignored.out());
  const std::string kept = text_or_empty(arv_camera_get_string(camera, automatic.feature, fault.out()));
  if (fault) return unanswered(settings, automatic, fault);
  return kept == automatic.wanted ? Status{} : stays(settings, automatic, kept, place);
}

/// Whether it is on after it was switched off.
Result<bool> stays_on(ArvCamera* camera, const CameraSettings& settings, const Automatic& automatic) {
  GFault ignored, fault;
  arv_camera_set_boolean(camera, automatic.feature, FALSE, ignored.out());
  const bool is_on = arv_camera_get_boolean(camera, automatic.feature, fault.out());
  if (fault) return unanswered(settings, automatic, fault);
  return is_on;
}

Status check_switch(ArvCamera* camera, const CameraSettings& settings, const Automatic& automatic,
                    const std::string& place) {
  const Result<bool> is_on = stays_on(camera, settings, automatic);
  if (!is_on) return tl::unexpected(is_on.error());
  return *is_on ? stays(settings, automatic, "on", place) : Status{};
}

/// A factor or a power.
Status check_one(ArvCamera* camera, const CameraSettings& settings, const Automatic& automatic,
                 const std::string& place) {
  GFault ignored, fault;
  arv_camera_set_float(camera, automatic.feature, 1, ignored.out());
  const double kept = arv_camera_get_float(camera, automatic.feature, fault.out());
  if (fault) return unanswered(settings, automatic, fault);
  return std::abs(kept - 1) <= one_tolerance ? Status{} : stays(settings, automatic, say(kept), place);
}

Status everywhere(ArvCamera* camera, const CameraSettings& settings, const Automatic& automatic, Check check) {
  return under_each(camera, settings, automatic.selector, [&](const std::string& place) -> Status {
    const Result<bool> is_there = has_feature(camera, settings, automatic.feature);
    if (!is_there) return tl::unexpected(is_there.error());
    return *is_there ? check(camera, settings, automatic, place) : Status{};
  });
}

/// Off, or else 1.
Status check_gamma(ArvCamera* camera, const CameraSettings& settings) {
  const Result<bool> has_switch = has_feature(camera, settings, gamma_switch.feature);
  if (!has_switch) return tl::unexpected(has_switch.error());
  const Result<bool> has_gamma = has_feature(camera, settings, gamma_power.feature);
  if (!has_gamma) return tl::unexpected(has_gamma.error());
  if (*has_switch) {
    const Result<bool> is_on = stays_on(camera, settings, gamma_switch);
    if (!is_on) return tl::unexpected(is_on.error());
    if (!*is_on) return {};
    if (!*has_gamma) return stays(settings, gamma_switch, "on", "");
  }
  return *has_gamma ? check_one(camera, settings, gamma_power, "") : Status{};
}

}  // namespace

Status switch_automatics_off(ArvCamera* camera, const CameraSettings& settings) {
  for (const Automatic& each : choices)
    if (Status off = everywhere(camera, settings, each, check_choice); !off) return off;
  for (const Automatic& each : switches)
    if (Status off = everywhere(camera, settings, each, check_switch); !off) return off;
  if (Status one = everywhere(camera, settings, balance, check_one); !one) return one;
  return check_gamma(camera, settings);
}

Status switch_mirrors_off(ArvCamera* camera, const CameraSettings& settings) {
  for (const Automatic& each : mirrors)
    if (Status off = everywhere(camera, settings, each, check_switch); !off) return off;
  return {};
}

}  // namespace lumifield
