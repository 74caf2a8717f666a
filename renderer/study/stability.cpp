#include "renderer/study/stability.h"

#include <cmath>

#include "renderer/study/ladder.h"
#include "renderer/study/stability_judge.h"

namespace lumifield {

Result<LightField> luminaire_of(const StabilityCase& each) {
  LightField field(each.geometry);
  for (std::size_t k = 0; k < each.cells.size(); ++k)
    if (!each.cells[k].value.empty())
      if (Status added = field.add(each.geometry.sampling.index(static_cast<int>(k)), each.cells[k]); !added)
        return tl::unexpected(added.error());
  return field;
}

std::vector<StabilityRow> try_case(const StabilityCase& each) {
  std::vector<StabilityRow> rows;
  const auto field = luminaire_of(each);
  if (!field) {
    for (const MethodInfo& method : methods())
      rows.push_back({method.method, each.name, StabilityOutcome::refused, std::nan(""), field.error().message()});
    return rows;
  }
  const StabilityTruth truth = stability_truth(each, *field);
  for (const MethodInfo& method : methods())
    rows.push_back(judged(method.method, each, truth, stability_answers(method.method, each, *field)));
  return rows;
}

Result<std::vector<StabilityRow>> stability_table(const StudyProgress& progress) {
  std::vector<StabilityRow> rows;
  std::vector<StabilityCase> cases;
  for (const StabilityLook look : {StabilityLook::plain, StabilityLook::half_shadow, StabilityLook::glossy})
    for (StabilityCase& each : stability_cases()) cases.push_back(with_look(std::move(each), look));
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (!progress(static_cast<double>(k) / static_cast<double>(cases.size()), "stability: " + cases[k].name))
      return study_stopped();
    for (StabilityRow& row : try_case(cases[k])) rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace lumifield
