#include "app/cli/print_result.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/cli/commands.h"

namespace lumifield {

std::string dump_json(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

int report_error(const Error& error, bool json) {
  std::fprintf(stderr, "lumifield: %s\n", error.message().c_str());
  if (json) {
    const nlohmann::ordered_json object{
        {"error", {{"what", error.what}, {"where", error.where}, {"remedy", error.remedy}}}};
    std::printf("%s\n", dump_json(object).c_str());
  }
  return exit_failed;
}

int print_result(const Result<nlohmann::ordered_json>& result, bool json,
                 const std::function<std::string(const nlohmann::ordered_json&)>& words) {
  if (!result) return report_error(result.error(), json);
  std::printf("%s\n", (json ? dump_json(*result) : words(*result)).c_str());
  return exit_done;
}

}  // namespace lumifield
