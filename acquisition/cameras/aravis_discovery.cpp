#include "acquisition/cameras/aravis_discovery.h"

#include <arv.h>
#include <chrono>
#include <thread>

#include "acquisition/cameras/aravis_handle.h"
#include "acquisition/cameras/aravis_settings.h"
#include "acquisition/cameras/gvcp_probe.h"
#include "acquisition/cameras/usb3_permission.h"

namespace lumifield {
namespace {

tl::unexpected<Error> not_there(const std::string& address, GvcpPresence presence) {
  return fail(presence == GvcpPresence::refused ? "the host answers, but no camera on it" : "no camera answers",
              "camera " + address, "check cable, power and address; `lumifield devices` lists what answers");
}

/// Silence is believed on the second try only: the first may fall into a time when the whole machine was held up.
constexpr int silences = 2;

GvcpAnswer probe_patiently(const std::string& ip) {
  GvcpAnswer answer;
  for (int tries = 0; tries < silences && answer.presence == GvcpPresence::silent; ++tries) answer = probe_gvcp(ip);
  return answer;
}

/// Asks the camera itself, which shows too whether it can be opened, and whether it offers what the bench file asks
/// for.
void ask_capabilities(DeviceReport& report, const CameraSettings* settings = nullptr) {
  if (!report.usable) return;
  const bool is_gige = is_ipv4_address(report.address);
  const Result<CameraHandle> camera = take_control({report.address, is_gige ? report.address : ""}, report.address);
  const Result<std::string> can =
      camera ? capabilities_of(camera->get(), report.address) : tl::unexpected(camera.error());
  if (can) report.capabilities = *can;
  Status offered = can ? Status() : tl::unexpected(can.error());
  if (offered && settings != nullptr) offered = check_offered(camera->get(), *settings);
  if (!offered) report.usable = false, report.reason = offered.error().what, report.remedy = offered.error().remedy;
}

bool is_gige(guint i) { return text_or_empty(arv_get_device_protocol(i)) == "GigEVision"; }

DeviceReport report_of(guint i) {
  DeviceReport report;
  report.role = "camera";
  report.serial = text_or_empty(arv_get_device_serial_nbr(i));
  report.name =
      text_or_empty(arv_get_device_vendor(i)) + " " + text_or_empty(arv_get_device_model(i)) + " " + report.serial;
  if (!is_gige(i)) {
    report.address = text_or_empty(arv_get_device_id(i));
    report.usable = true;
    return report;
  }
  report.address = text_or_empty(arv_get_device_address(i));
  const GvcpAnswer answer = probe_gvcp(report.address);
  if (answer.presence != GvcpPresence::present) {
    report.reason = "it answers the discovery, but cannot be reached";
    report.remedy = "give it an address in the subnet of this computer's network card";
  } else if (answer.controlled) {
    report.reason = "held by another program";
    report.remedy = "close the other program";
  } else {
    report.usable = true;
  }
  return report;
}

std::vector<DeviceReport> discover() {
  arv_update_device_list();
  std::vector<DeviceReport> reports;
  for (guint i = 0; i < arv_get_n_devices(); ++i) reports.push_back(report_of(i));
  for (DeviceReport& camera : usb3_cameras_without_permission()) reports.push_back(std::move(camera));
  return reports;
}

}  // namespace

std::vector<DeviceReport> find_aravis_cameras() {
  std::vector<DeviceReport> reports = discover();
  for (DeviceReport& camera : reports) ask_capabilities(camera);
  return reports;
}

DeviceReport probe_aravis_camera(const CameraSettings& settings) {
  const auto unusable = [&](const Error& error) -> DeviceReport {
    return {"camera", {}, settings.address, false, error.what, error.remedy};
  };
  const Result<AravisAddress> at = aravis_address(settings.address);
  if (!at) return unusable(at.error());
  for (DeviceReport& report : discover()) {
    if (report.address != at->name) continue;
    ask_capabilities(report, &settings);
    return std::move(report);
  }

  // In another subnet no discovery reaches it.
  if (at->ipv4.empty()) return unusable(not_there(settings.address, GvcpPresence::silent).value());
  const GvcpAnswer answer = probe_gvcp(at->ipv4);
  if (answer.presence != GvcpPresence::present) return unusable(not_there(settings.address, answer.presence).value());
  if (answer.controlled) return unusable(held_by_another(settings.address).value());
  DeviceReport report{"camera", {}, at->ipv4, true, {}, {}};
  ask_capabilities(report, &settings);
  return report;
}

Result<AravisAddress> aravis_address(const std::string& name) {
  if (is_ipv4_address(name)) return AravisAddress{name, name};
  std::vector<AravisAddress> found;
  std::string list;
  for (int tries = 0; tries < silences && found.empty(); ++tries) {
    arv_update_device_list();
    for (guint i = 0; i < arv_get_n_devices(); ++i) {
      const std::string id = text_or_empty(arv_get_device_id(i)), address = text_or_empty(arv_get_device_address(i));
      if (name != id && name != text_or_empty(arv_get_device_serial_nbr(i))) continue;
      found.push_back(is_gige(i) ? AravisAddress{address, address} : AravisAddress{id, ""});
      list.append(list.empty() ? "" : ", ").append(id + (is_gige(i) ? " at " + address : ""));
    }
  }
  if (found.empty()) return not_there(name, GvcpPresence::silent);
  if (found.size() > 1)
    return fail("is the name of " + std::to_string(found.size()) + " cameras: " + list, "camera " + name,
                "give the id or the address of one of them");
  return found.front();
}

Status await_free(const std::string& ip, const std::string& name) {
  GvcpAnswer answer = probe_patiently(ip);
  if (answer.presence != GvcpPresence::present) return not_there(name, answer.presence);
  if (!answer.controlled) return {};
  std::this_thread::sleep_for(gvcp_heartbeat_timeout(ip) + std::chrono::milliseconds(300));
  answer = probe_patiently(ip);
  if (answer.presence != GvcpPresence::present) return not_there(name, answer.presence);
  if (answer.controlled) return held_by_another(name);
  return {};
}

tl::unexpected<Error> held_by_another(const std::string& name) {
  return fail("held by another program", "camera " + name, "close the other program");
}

}  // namespace lumifield
