#include "acquisition/cameras/aravis_handle.h"

#include <algorithm>
#include <arv.h>

#include "acquisition/cameras/aravis_gain.h"
#include "acquisition/cameras/aravis_settings.h"
#include "luminaire/wording.h"

namespace lumifield {
namespace {

constexpr double s_per_us = 1e-6;

std::string range(double low, double high) { return say(low) + " to " + say(high); }

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text.append(text.empty() ? "" : ", ").append(word);
  return text;
}

/// Of a USB3 Vision camera that cannot be claimed, Aravis 0.8.26 joins a thread that it never began, and GLib complains
/// on the terminal. Of this one complaint nothing is heard while it lives.
class WithoutComplaint {
 public:
  WithoutComplaint() : handler_(g_log_set_handler("GLib", G_LOG_LEVEL_CRITICAL, pass_on, nullptr)) {}
  ~WithoutComplaint() { g_log_remove_handler("GLib", handler_); }
  WithoutComplaint(const WithoutComplaint&) = delete;
  WithoutComplaint& operator=(const WithoutComplaint&) = delete;

 private:
  static void pass_on(const char* domain, GLogLevelFlags level, const char* text, gpointer data) {
    if (text_or_empty(text) != "g_thread_join: assertion 'thread' failed")
      g_log_default_handler(domain, level, text, data);
  }
  guint handler_;
};

}  // namespace

void ReleaseCamera::operator()(ArvCamera* camera) const { g_object_unref(camera); }

Result<CameraHandle> take_control(const AravisAddress& at, const std::string& name) {
  GFault fault;
  const WithoutComplaint quiet;
  CameraHandle handle(arv_camera_new(at.name.c_str(), fault.out()));
  if (!handle && at.ipv4.empty() && fault.text().find("LIBUSB_ERROR_BUSY") != std::string::npos)
    return held_by_another(name);
  if (!handle)
    return fail("cannot be opened (" + fault.text() + ")", "camera " + name,
                "close other programs that may use it, then switch it off and on");
  ArvDevice* const device = arv_camera_get_device(handle.get());
  const bool is_gige = ARV_IS_GV_DEVICE(device);
  if (is_gige == at.ipv4.empty())
    return fail("is another kind of camera than was found there", "camera " + name, "open it again");
  if (is_gige && !arv_gv_device_is_controller(ARV_GV_DEVICE(device))) return held_by_another(name);
  return handle;
}

Result<std::string> capabilities_of(ArvCamera* camera, const std::string& name) {
  CameraSettings settings;
  settings.address = name;
  const Result<std::vector<std::string>> formats = usable_pixel_formats(camera, settings);
  if (!formats) return tl::unexpected(formats.error());
  const Result<AravisGain> gain = aravis_gain(camera, settings);
  if (!gain) return tl::unexpected(gain.error());
  if (formats->empty())
    return fail("offers no pixel format that can be measured with", "camera " + name, "use a camera with raw pictures");
  std::string text = joined(*formats) + "; ";
  // What a camera does not answer as it stands now, it may when it is set.
  GFault no_size, no_times, no_binning;
  gint smallest = 0, width = 0, height = 0, columns = 1, rows = 1;
  double shortest_us = 0, longest_us = 0;
  arv_camera_get_sensor_size(camera, &width, &height, no_size.out());
  if (!no_size) text += std::to_string(width) + "x" + std::to_string(height) + " px; ";
  arv_camera_get_exposure_time_bounds(camera, &shortest_us, &longest_us, no_times.out());
  if (!no_times) text += "exposures of " + range(shortest_us * s_per_us, longest_us * s_per_us) + " s; ";
  text += gain->is_there ? "gain " + range(gain->low, gain->high) + (gain->is_db ? " dB" : ", not in dB") : "no gain";
  if (arv_camera_is_binning_available(camera, no_binning.out())) {
    arv_camera_get_x_binning_bounds(camera, &smallest, &columns, no_binning.out());
    arv_camera_get_y_binning_bounds(camera, &smallest, &rows, no_binning.out());
  }
  if (const int most = std::min(columns, rows); most > 1) text += "; binning to " + std::to_string(most);
  return text;
}

}  // namespace lumifield
