#include "acquisition/cameras/aravis_selectors.h"

#include <arv.h>

#include "acquisition/cameras/aravis_settings.h"

namespace lumifield {
namespace {

std::string question(const char* feature) { return std::string("a question for ") + feature; }

}  // namespace

Result<bool> has_feature(ArvCamera* camera, const CameraSettings& settings, const char* feature) {
  GFault fault;
  const bool is_there = arv_camera_is_feature_available(camera, feature, fault.out());
  if (fault) return refused(settings, question(feature), fault);
  return is_there;
}

Result<std::vector<std::string>> offered_values(ArvCamera* camera, const CameraSettings& settings,
                                                const char* selector) {
  const Result<bool> is_there = has_feature(camera, settings, selector);
  if (!is_there) return tl::unexpected(is_there.error());
  if (!*is_there) return std::vector<std::string>();
  GFault fault;
  guint count = 0;
  const char** const names = arv_camera_dup_available_enumerations_as_strings(camera, selector, &count, fault.out());
  std::vector<std::string> values = take_names(names, count);
  if (fault) return refused(settings, question(selector), fault);
  return values;
}

Result<std::string> selected_value(ArvCamera* camera, const CameraSettings& settings, const char* selector) {
  GFault fault;
  std::string value = text_or_empty(arv_camera_get_string(camera, selector, fault.out()));
  if (fault) return refused(settings, question(selector), fault);
  return value;
}

Status select_value(ArvCamera* camera, const CameraSettings& settings, const char* selector, const std::string& value) {
  GFault fault;
  arv_camera_set_string(camera, selector, value.c_str(), fault.out());
  const Result<std::string> taken = selected_value(camera, settings, selector);
  if (!taken) return tl::unexpected(taken.error());
  if (*taken == value) return {};  // a selector of one value may not take it again
  const std::string wanted = std::string("the ") + selector + " " + value;
  if (fault) return refused(settings, wanted, fault);
  return fail(std::string("took the ") + selector + " " + *taken + " for " + value, "camera " + settings.address,
              "check the camera's manual, or use another camera");
}

std::string place_of(const char* selector, const std::string& value) {
  return std::string(" under ") + selector + " " + value;
}

Status under_each(ArvCamera* camera, const CameraSettings& settings, const char* selector,
                  const std::function<Status(const std::string& place)>& step) {
  if (selector == nullptr) return step("");
  const Result<std::vector<std::string>> values = offered_values(camera, settings, selector);
  if (!values) return tl::unexpected(values.error());
  if (values->empty()) return step("");
  const Result<std::string> before = selected_value(camera, settings, selector);
  if (!before) return tl::unexpected(before.error());
  Status done;
  for (auto value = values->begin(); done && value != values->end(); ++value) {
    done = select_value(camera, settings, selector, *value);
    if (done) done = step(place_of(selector, *value));
  }
  const Status back = select_value(camera, settings, selector, *before);
  return done ? back : done;
}

}  // namespace lumifield
