#include "acquisition/cameras/aravis_gain.h"

#include <algorithm>
#include <arv.h>
#include <cmath>
#include <vector>

#include "acquisition/cameras/aravis_selectors.h"
#include "acquisition/cameras/aravis_settings.h"
#include "luminaire/wording.h"

namespace lumifield {
namespace {

constexpr const char* selector = "GainSelector";

tl::unexpected<Error> error(const CameraSettings& settings, std::string what, std::string remedy) {
  return fail(std::move(what), "camera " + settings.address, std::move(remedy));
}

/// Of the feature that Aravis 0.8 takes for the gain.
std::string unit_of_gain(ArvCamera* camera) {
  ArvDevice* const device = arv_camera_get_device(camera);
  for (const char* name : {"Gain", "GainRaw", "GainAbs"})
    if (ArvGcNode* const node = arv_device_get_feature(device, name); node != nullptr && ARV_IS_GC_FLOAT(node))
      return text_or_empty(arv_gc_float_get_unit(ARV_GC_FLOAT(node)));
  return {};  // steps
}

bool same(const AravisGain& gain, double a, double b) {
  constexpr double tolerance_db = 0.05, tolerance = 0.005;
  return std::abs(a - b) <= (gain.is_db ? tolerance_db : tolerance * std::max(1.0, std::abs(b)));
}

/// What it is then. A camera that does not take it may have it already: what is read back counts.
Result<double> set_to(ArvCamera* camera, const CameraSettings& settings, double wanted, const std::string& what) {
  GFault ignored, fault;
  arv_camera_set_gain(camera, wanted, ignored.out());
  const double taken = arv_camera_get_gain(camera, fault.out());
  if (fault) return refused(settings, what, fault);
  return taken;
}

Status make_neutral(ArvCamera* camera, const CameraSettings& settings, const std::string& place) {
  const Result<AravisGain> gain = aravis_gain(camera, settings);
  if (!gain) return tl::unexpected(gain.error());
  if (!gain->is_there) return {};
  const Result<double> kept = set_to(camera, settings, gain->neutral(), "a question for its gain" + place);
  if (!kept) return tl::unexpected(kept.error());
  if (same(*gain, *kept, gain->neutral())) return {};
  return error(settings, "changes values by a second gain: Gain stays " + say(*kept) + gain->unit() + place,
               "set it to " + say(gain->neutral()) + gain->unit() + " with the maker's program, or use another camera");
}

std::string whole_of(const std::vector<std::string>& offered) {
  if (offered.size() == 1) return offered.front();
  for (const char* whole : {"All", "AnalogAll", "DigitalAll"})
    if (std::ranges::find(offered, whole) != offered.end()) return whole;
  return {};
}

/// A gain of one part would make the parts differ.
Status check_parts(ArvCamera* camera, const CameraSettings& settings, const std::vector<std::string>& parts) {
  const Result<AravisGain> gain = aravis_gain(camera, settings);
  if (!gain) return tl::unexpected(gain.error());
  if (!gain->is_there || same(*gain, settings.gain, gain->neutral())) return {};
  std::string names;
  for (const std::string& part : parts) names.append(names.empty() ? "" : ", ").append(part);
  return error(settings, "has no gain of the whole picture, only of " + names,
               "set \"gain\": " + say(gain->neutral()) + " in the bench file");
}

/// The gain that is measured with is selected last: it undoes what was set under an alias of it.
Status select_gain(ArvCamera* camera, const CameraSettings& settings) {
  const Result<std::vector<std::string>> offered = offered_values(camera, settings, selector);
  if (!offered) return tl::unexpected(offered.error());
  if (offered->empty()) return {};
  const std::string whole = whole_of(*offered);
  for (const std::string& other : *offered) {
    if (other == whole) continue;
    if (Status taken = select_value(camera, settings, selector, other); !taken) return taken;
    if (Status none = make_neutral(camera, settings, place_of(selector, other)); !none) return none;
  }
  return whole.empty() ? check_parts(camera, settings, *offered) : select_value(camera, settings, selector, whole);
}

}  // namespace

double AravisGain::neutral() const {
  if (is_db) return 0;
  return low > 0 && low <= 1 && high >= 1 ? 1 : low;
}

Result<AravisGain> aravis_gain(ArvCamera* camera, const CameraSettings& settings) {
  AravisGain gain;
  GFault fault;
  gain.is_there = arv_camera_is_gain_available(camera, fault.out());
  if (!fault && gain.is_there) arv_camera_get_gain_bounds(camera, &gain.low, &gain.high, fault.out());
  if (fault) return refused(settings, "a question for its gain", fault);
  gain.is_db = gain.is_there && g_ascii_strcasecmp(unit_of_gain(camera).c_str(), "dB") == 0;
  return gain;
}

Result<double> set_aravis_gain(ArvCamera* camera, const CameraSettings& settings) {
  if (Status selected = select_gain(camera, settings); !selected) return tl::unexpected(selected.error());
  const Result<AravisGain> gain = aravis_gain(camera, settings);
  if (!gain) return tl::unexpected(gain.error());
  if (!gain->is_there) {
    if (settings.gain == 0) return 0.0;
    return error(settings, "has no gain to set", "set \"gain\": 0 in the bench file");
  }
  const std::string unit = gain->unit(), wanted = "a gain of " + say(settings.gain) + unit;
  if (!(settings.gain >= gain->low && settings.gain <= gain->high))
    return error(settings, wanted + " is out of its range",
                 "choose one from " + say(gain->low) + " to " + say(gain->high) + unit +
                     (gain->is_db ? "" : " (it counts in a unit of its own, not dB)"));
  const Result<double> taken = set_to(camera, settings, settings.gain, wanted);
  if (!taken) return taken;
  if (!same(*gain, *taken, settings.gain))
    return error(settings, "took a gain of " + say(*taken) + unit + " for " + say(settings.gain) + unit,
                 "write the gain that it took into the bench file");
  return gain->is_db ? *taken : 0.0;
}

}  // namespace lumifield
