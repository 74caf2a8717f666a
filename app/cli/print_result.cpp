#include "app/cli/print_result.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/cli/commands.h"

namespace lumifield {

std::string dump_json(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

int report_error(const Error& error, bool json, const std::string& go_on) {
  std::fprintf(stderr, "lumifield: %s\n", error.message().c_str());
  if (!go_on.empty()) std::fprintf(stderr, "lumifield: %s\n", go_on.c_str());
  if (json) {
    nlohmann::ordered_json object{{"error", {{"what", error.what}, {"where", error.where}, {"remedy", error.remedy}}}};
    if (!go_on.empty()) object["error"]["go_on"] = go_on;
    std::printf("%s\n", dump_json(object).c_str());
  }
  const bool waits = error.kind == ErrorKind::stopped || error.kind == ErrorKind::waiting;
  return waits ? exit_stopped : exit_failed;
}

int print_result(const Result<nlohmann::ordered_json>& result, bool json,
                 const std::function<std::string(const nlohmann::ordered_json&)>& words) {
  if (!result) return report_error(result.error(), json);
  std::printf("%s\n", (json ? dump_json(*result) : words(*result)).c_str());
  return exit_done;
}

nlohmann::ordered_json method_summary(const MethodSettings& settings) {
  const MethodInfo& method = info(settings.method);
  nlohmann::ordered_json summary{{"method", method.name}};
  if (method.cost == MethodCost::pixels_per_support) summary["lod"] = settings.lod;
  if (method.samples > 0) {
    summary[method.cost == MethodCost::lights ? "lights" : "samples"] = settings.samples;
    summary["seed"] = settings.seed;
  }
  if (settings.method == Method::shift_invariant) summary["spots"] = to_string(settings.spots.look_up);
  if (averages_light(settings.method)) summary["filter"] = settings.filter ? "on" : "off";
  return summary;
}

std::string method_words(const nlohmann::ordered_json& summary) {
  std::string text = summary["method"].get<std::string>();
  for (const char* count : {"samples", "lights"})
    if (summary.contains(count)) {
      char words[40];
      std::snprintf(words, sizeof words, " with %.0f %s", summary[count].get<double>(), count);
      text += words;
    }
  if (summary.value("lod", 0.0) > 0) {
    char words[40];
    std::snprintf(words, sizeof words, " at %g pixels per support", summary["lod"].get<double>());
    text += words;
  }
  return summary.value("filter", "on") == "off" ? text + ", unfiltered" : text;
}

}  // namespace lumifield
