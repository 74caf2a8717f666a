// A scan in which cells are taken again, for `survive` to kill. It says on stdout when the retakes begin, when they are
// durable, and when it begins to close, all cells stored.   retaking_scan BENCH PLAN OUT

#include <array>
#include <cstdio>

#include "app/session/scan_session.h"

namespace lumifield {
namespace {

constexpr int retakes = 3, after_cells = 4;

int report(const Error& error) {
  std::fprintf(stderr, "lumifield: %s\n", error.message().c_str());
  return 1;
}

void say(const char* word) {
  std::puts(word);
  std::fflush(stdout);
}

/// Takes the first three cells again once four are stored.
class Retakes {
 public:
  void stored(const CellEntry& entry, ScanSession& session) {
    if (cells_ < retakes) first_[static_cast<std::size_t>(cells_)] = entry.cell;
    if (++cells_ == after_cells) {
      session.retake(first_);
      say("retaking");
    }
    if (entry.generation > 1 && ++taken_again_ == retakes) say("retaken");
  }
  int cells() const { return cells_ - taken_again_; }

 private:
  std::array<CellIndex, retakes> first_;
  int cells_ = 0, taken_again_ = 0;
};

int run(int argc, char** argv) {
  if (argc < 4) return report({"no bench, plan and folder", "", "retaking_scan BENCH PLAN OUT"});
  ScanRequest request;
  auto bench = read_bench(argv[1]);
  if (!bench) return report(bench.error());
  auto plan = read_plan(argv[2]);
  if (!plan) return report(plan.error());
  request.bench = std::move(*bench);
  request.plan = std::move(*plan);
  request.out = argv[3];
  auto session = ScanSession::start(std::move(request));
  if (!session) return report(session.error());
  Retakes again;
  while (const auto event = (*session)->next_event())
    if (const auto* cell = std::get_if<CellStored>(&*event)) again.stored(cell->entry, **session);
  if (again.cells() == (*session)->geometry().sampling.cells()) say("closing");
  const auto summary = (*session)->wait();
  return summary ? 0 : report(summary.error());
}

}  // namespace
}  // namespace lumifield

int main(int argc, char** argv) { return lumifield::run(argc, argv); }
