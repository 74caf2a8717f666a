#include "app/session/rehearsal.h"

#include <algorithm>

#include "acquisition/scan/motion_time.h"
#include "app/session/device_names.h"
#include "app/session/guarded.h"
#include "app/session/instruments.h"
#include "app/session/stored_bytes.h"
#include "calibration/develop.h"

namespace lumifield {

namespace {

/// Keeps the cell and the reading.
class RehearsalSink final : public ScanSink {
 public:
  explicit RehearsalSink(const std::function<void(const ScanProgress&)>& told) : told_(told) {}
  void cell(RawCell raw) override { shot = std::move(raw); }
  void reference(const ReferenceReading& reading) override { signal_dn_per_s = reading.signal_dn_per_s; }
  void progress(const ScanProgress& progress) override { told_(progress); }
  void notice(const std::string&) override {}  // without a recovery nothing is helped

  RawCell shot;
  double signal_dn_per_s = 0;

 private:
  const std::function<void(const ScanProgress&)>& told_;
};

double brightest_share(const RawCell& raw, double saturation_dn) {
  double most = 0;
  for (const RawPass& pass : raw.passes)
    most = std::max<double>(most, *std::ranges::max_element(pass.bracket.back().dn));
  return most / saturation_dn;
}

/// Of the disk that a path will lie on.
std::optional<double> room_for(std::filesystem::path out) {
  std::error_code code;
  out = std::filesystem::absolute(out, code);
  while (!code && !out.empty() && !std::filesystem::exists(out, code) && out.has_relative_path())
    out = out.parent_path();
  const std::filesystem::space_info space = std::filesystem::space(out, code);
  return code ? std::nullopt : std::optional(static_cast<double>(space.available));
}

Result<Rehearsal> run(const RehearsalRequest& request, std::stop_token stop,
                      const std::function<void(const ScanProgress&)>& progress) {
  const auto [bench, plan] = std::tie(request.bench, request.plan);
  const auto steps = make_rehearsal(bench, plan, request.shot.value_or(plan.reference.cell));
  if (!steps) return tl::unexpected(steps.error());
  const auto whole = make_scan_plan(bench, plan);
  if (!whole) return tl::unexpected(whole.error());
  const bool one_pass = bench.filter.change == PassChange::by_operator;  // whose slide is in
  auto developer = Developer::create(one_pass ? with_pass(bench, 0) : bench, plan);
  if (!developer) return tl::unexpected(developer.error());

  BenchView unseen;
  Instruments instruments(bench, request.devices, unseen);
  if (Status opened = instruments.open(); !opened) return tl::unexpected(opened.error());
  Scanner scanner(instruments.camera(), instruments.stage(), bench, plan);
  RehearsalSink sink(progress);
  if (Status ran = scanner.run(*steps, sink, std::move(stop)); !ran) return tl::unexpected(ran.error());
  const auto image = developer->develop(sink.shot);
  if (!image) return fail_in("test shot", image.error());

  Rehearsal told;
  told.camera = name_of(instruments.camera().info());
  told.stage = name_of(instruments.stage().info());
  told.places = static_cast<int>(std::ranges::count_if(
      steps->steps, [](const ScanStep& step) { return std::holds_alternative<VisitStep>(step); }));
  told.shot = sink.shot.cell;
  told.quality = image->quality;
  told.brightest_share = brightest_share(sink.shot, bench.sensor.saturation_dn);
  told.signal_dn_per_s = sink.signal_dn_per_s;
  told.took_s = scanner.timing().total_s;
  told.cells = whole->cells;
  const StageSpeed speed = stage_speed(bench.stage, instruments.stage().info());
  told.scan_s = scan_time_s(whole->steps, bench, plan, speed);
  told.scan_bytes = whole->cells * (stored_cell_bytes(developer->geometry()) + half_cells_bytes(bench, plan));
  told.free_bytes = room_for(request.out);
  return told;
}

}  // namespace

Result<Rehearsal> rehearse(const RehearsalRequest& request, std::stop_token stop,
                           const std::function<void(const ScanProgress&)>& progress) {
  return guarded("rehearsal", [&] { return run(request, std::move(stop), progress); });
}

}  // namespace lumifield
