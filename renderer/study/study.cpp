#include "renderer/study/study.h"

namespace lumifield {

std::string_view to_string(StabilityOutcome outcome) {
  switch (outcome) {
    case StabilityOutcome::ok:
      return "ok";
    case StabilityOutcome::refused:
      return "refused";
    case StabilityOutcome::failed:
      return "failed";
  }
  return "failed";
}

}  // namespace lumifield
