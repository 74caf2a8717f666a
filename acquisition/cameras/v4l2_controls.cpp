#include "acquisition/cameras/v4l2_controls.h"

#include <cmath>
#include <linux/videodev2.h>
#include <optional>

#include "luminaire/wording.h"

namespace lumifield {
namespace {

constexpr double unit_s = 1e-4;  // of V4L2_CID_EXPOSURE_ABSOLUTE

struct Automatic {
  std::uint32_t id;
  std::string_view name;
  int off;
};

// White balance and gain before what sets them: some cameras keep the last automatic value.
constexpr Automatic automatics[] = {
    {V4L2_CID_EXPOSURE_AUTO, "automatic exposure", V4L2_EXPOSURE_MANUAL},
    {V4L2_CID_AUTOGAIN, "automatic gain", 0},
    {V4L2_CID_ISO_SENSITIVITY_AUTO, "automatic sensitivity", V4L2_ISO_SENSITIVITY_MANUAL},
    {V4L2_CID_AUTO_WHITE_BALANCE, "automatic white balance", 0},
    {V4L2_CID_AUTO_N_PRESET_WHITE_BALANCE, "automatic white balance", V4L2_WHITE_BALANCE_MANUAL},
    {V4L2_CID_HUE_AUTO, "automatic hue", 0},
    {V4L2_CID_CHROMA_AGC, "automatic chroma gain", 0},
    {V4L2_CID_AUTOBRIGHTNESS, "automatic brightness", 0},
    {V4L2_CID_FOCUS_AUTO, "automatic focus", 0},
    {V4L2_CID_BACKLIGHT_COMPENSATION, "backlight compensation", 0},
    {V4L2_CID_WIDE_DYNAMIC_RANGE, "wide dynamic range", 0},
    {V4L2_CID_IMAGE_STABILIZATION, "image stabilisation", 0},
    {V4L2_CID_SCENE_MODE, "scene mode", V4L2_SCENE_MODE_NONE},
    {V4L2_CID_POWER_LINE_FREQUENCY, "power-line filter", V4L2_CID_POWER_LINE_FREQUENCY_DISABLED},
};
constexpr int gamma_of_one = 100;  // USB Video Class 1.5, 4.2.2.3.8
constexpr int longest_gamma = 500;

std::optional<v4l2_queryctrl> find(const V4l2Node& node, std::uint32_t id) {
  v4l2_queryctrl control{};
  control.id = id;
  if (node.call(VIDIOC_QUERYCTRL, &control) != 0 || (control.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return std::nullopt;
  return control;
}

std::optional<int> read(const V4l2Node& node, std::uint32_t id) {
  v4l2_control control{id, 0};
  if (node.call(VIDIOC_G_CTRL, &control) != 0) return std::nullopt;
  return control.value;
}

int write(const V4l2Node& node, std::uint32_t id, int value) {
  v4l2_control control{id, value};
  return node.call(VIDIOC_S_CTRL, &control);
}

/// Gamma counts in hundredths in cameras of the USB class, whose range is 1 … 500; others' units are not known.
bool has_gamma_of_one(const v4l2_queryctrl& gamma) {
  return gamma.minimum >= 1 && gamma.minimum <= gamma_of_one && gamma.maximum >= gamma_of_one &&
         gamma.maximum <= longest_gamma;
}

/// Every control that must be off, with the value that is off.
template <class Act>
Status for_each_automatic(const V4l2Node& node, Act act) {
  for (const Automatic& automatic : automatics)
    if (const auto control = find(node, automatic.id))
      if (Status done = act(automatic); !done) return done;
  const auto gamma = find(node, V4L2_CID_GAMMA);
  if (!gamma) return {};
  if (gamma->type == V4L2_CTRL_TYPE_BOOLEAN) return act(Automatic{V4L2_CID_GAMMA, "gamma", 0});
  if (!has_gamma_of_one(*gamma))
    return node.error("its gamma cannot be made 1: the control goes from " + std::to_string(gamma->minimum) + " to " +
                          std::to_string(gamma->maximum) + " in a unit of its own",
                      "use a camera with a linear response");
  return act(Automatic{V4L2_CID_GAMMA, "gamma", gamma_of_one});
}

Status switch_off(const V4l2Node& node) {
  return for_each_automatic(node, [&](const Automatic& automatic) -> Status {
    if (read(node, automatic.id) == automatic.off) return {};
    // Whether it took this is read back, with all others, at the end.
    if (const int failure = write(node, automatic.id, automatic.off); failure == EBUSY || means_gone(failure))
      return node.refused(std::string(automatic.name) + " off", failure);
    return {};
  });
}

Status verify_off(const V4l2Node& node) {
  return for_each_automatic(node, [&](const Automatic& automatic) -> Status {
    const std::optional<int> now = read(node, automatic.id);
    if (now == automatic.off) return {};
    return node.error("does not measure: its " + std::string(automatic.name) + " stays at " +
                          (now ? std::to_string(*now) : "a value that it does not tell") + ", which must be " +
                          std::to_string(automatic.off),
                      "switch it off in the camera, or use another one");
  });
}

Result<double> set_gain(const V4l2Node& node, double gain) {
  if (Status offered = V4l2Controls::check_gain(node, gain); !offered) return tl::unexpected(offered.error());
  if (!find(node, V4L2_CID_GAIN)) return 0.0;
  if (const int failure = write(node, V4L2_CID_GAIN, static_cast<int>(gain)); failure != 0)
    return node.refused("a gain of " + std::to_string(static_cast<int>(gain)), failure);
  const std::optional<int> taken = read(node, V4L2_CID_GAIN);
  if (taken != static_cast<int>(gain))
    return node.error("took a gain of " + (taken ? std::to_string(*taken) : "none") + " for " +
                          std::to_string(static_cast<int>(gain)),
                      "write the gain that it took into the bench file");
  return gain;
}

tl::unexpected<Error> no_exposure_time(const V4l2Node& node) {
  return node.error("tells no exposure time in seconds (it has no control exposure_time_absolute)",
                    "use a camera whose exposure time can be set");
}

}  // namespace

Result<V4l2Controls> V4l2Controls::apply(const V4l2Node& node, const CameraSettings& settings) {
  V4l2Controls controls(node);
  if (Status off = switch_off(node); !off) return tl::unexpected(off.error());
  controls.have_gamma_ = find(node, V4L2_CID_GAMMA).has_value();
  const auto exposure = find(node, V4L2_CID_EXPOSURE_ABSOLUTE);
  if (!exposure) return no_exposure_time(node);
  controls.shortest_ = exposure->minimum, controls.longest_ = exposure->maximum;
  const Result<double> gain = set_gain(node, settings.gain);
  if (!gain) return tl::unexpected(gain.error());
  if (Status off = verify_off(node); !off) return tl::unexpected(off.error());
  return controls;
}

std::string V4l2Controls::shortcoming(const V4l2Node& node) {
  if (!find(node, V4L2_CID_EXPOSURE_ABSOLUTE)) return no_exposure_time(node).value().what;
  const Status found = for_each_automatic(node, [&](const Automatic& automatic) -> Status {
    const auto control = find(node, automatic.id);
    if ((control->flags & V4L2_CTRL_FLAG_READ_ONLY) == 0 || read(node, automatic.id) == automatic.off) return {};
    return node.error("its " + std::string(automatic.name) + " cannot be switched off", {});
  });
  return found ? "" : found.error().what;
}

Status V4l2Controls::check_gain(const V4l2Node& node, double gain) {
  const auto control = find(node, V4L2_CID_GAIN);
  if (!control && gain == 0) return {};
  if (!control) return node.error("has no gain to set", "set \"gain\": 0 in the bench file");
  if (gain == std::round(gain) && gain >= control->minimum && gain <= control->maximum) return {};
  return node.error(
      "its gain control has no " + say(gain),
      "choose a whole number from " + std::to_string(control->minimum) + " to " + std::to_string(control->maximum));
}

std::string V4l2Controls::capabilities(const V4l2Node& node) {
  std::string text;
  if (const auto exposure = find(node, V4L2_CID_EXPOSURE_ABSOLUTE))
    text = "exposures of " + say(std::max(1, exposure->minimum) * unit_s) + " to " + say(exposure->maximum * unit_s) +
           " s; ";
  const auto gain = find(node, V4L2_CID_GAIN);
  if (!gain) return text + "no gain";
  return text + "gain " + std::to_string(gain->minimum) + " to " + std::to_string(gain->maximum) + ", not in dB";
}

Result<double> V4l2Controls::set_exposure(double exposure_s) const {
  const double units = std::round(exposure_s / unit_s);
  if (!(units >= shortest_ && units <= longest_) || units < 1)
    return refused_for_good(node_
                                ->error("an exposure of " + say(exposure_s) + " s is out of its range",
                                        "choose one from " + say(std::max(1, shortest_) * unit_s) + " to " +
                                            say(longest_ * unit_s) + " s, in steps of 100 µs")
                                .value());
  if (const int failure = write(*node_, V4L2_CID_EXPOSURE_ABSOLUTE, static_cast<int>(units)); failure != 0)
    return node_->refused("an exposure of " + say(exposure_s) + " s", failure);
  const std::optional<int> taken = read(*node_, V4L2_CID_EXPOSURE_ABSOLUTE);
  if (!taken || *taken < 1) return node_->error("does not tell its exposure time", "check cable and power");
  return *taken * unit_s;
}

}  // namespace lumifield
