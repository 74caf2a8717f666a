#include "app/session/rehearsal.h"

#include <algorithm>

#include "app/session/device_names.h"
#include "app/session/guarded.h"
#include "app/session/instruments.h"
#include "calibration/develop.h"

namespace lumifield {

namespace {

/// Keeps the cell and the reading.
class RehearsalSink final : public ScanSink {
 public:
  RehearsalSink(const std::function<void(const ScanProgress&)>& told, BenchView& view) : told_(told), view_(view) {}
  void cell(RawCell raw) override { shot = std::move(raw); }
  void reference(const ReferenceReading& reading) override { signal_dn_per_s = reading.signal_dn_per_s; }
  void progress(const ScanProgress& progress) override { told_(progress); }
  void notice(const std::string&) override {}  // without a recovery nothing is helped
  void seen(const Bracket& bracket, const std::string& place, const Vec2& stage_mm) override {
    view_.show(bracket, place, stage_mm);
  }

  RawCell shot;
  double signal_dn_per_s = 0;

 private:
  const std::function<void(const ScanProgress&)>& told_;
  BenchView& view_;
};

double brightest_share(const RawCell& raw, double saturation_dn) {
  double most = 0;
  for (const RawPass& pass : raw.passes)
    most = std::max<double>(most, *std::ranges::max_element(pass.bracket.back().dn));
  return most / saturation_dn;
}

Result<Rehearsal> run(const RehearsalRequest& request, std::stop_token stop,
                      const std::function<void(const ScanProgress&)>& progress) {
  const Bench& bench = request.bench;
  Plan plan = request.plan;
  plan.stabilisation.reset();  // the scan's: what is tried here is no measurement
  const auto steps = make_rehearsal(bench, plan, request.shot.value_or(plan.reference.cell));
  if (!steps) return tl::unexpected(steps.error());
  const auto whole = make_scan_plan(bench, plan);
  if (!whole) return tl::unexpected(whole.error());
  const bool one_pass = bench.filter.change == PassChange::by_operator;  // whose slide is in
  auto developer = Developer::create(one_pass ? with_pass(bench, 0) : bench, plan);
  if (!developer) return tl::unexpected(developer.error());

  BenchView unseen;
  BenchView& view = request.bench_view ? *request.bench_view : unseen;
  Instruments instruments(bench, request.devices, view);
  if (Status opened = instruments.open(); !opened) return tl::unexpected(opened.error());
  Scanner scanner(instruments.camera(), instruments.stage(), bench, plan);
  RehearsalSink sink(progress, view);
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
  told.scan = predict(at_the_pace_of(instruments.camera(), request.plan, bench), request.plan, *whole,
                      instruments.stage().info(), request.out);
  return told;
}

}  // namespace

Result<Rehearsal> rehearse(const RehearsalRequest& request, std::stop_token stop,
                           const std::function<void(const ScanProgress&)>& progress) {
  return guarded("rehearsal", [&] { return run(request, std::move(stop), progress); });
}

}  // namespace lumifield
