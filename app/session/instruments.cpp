#include "app/session/instruments.h"

#include <utility>

#include "app/session/device_names.h"

namespace lumifield {

namespace {

tl::unexpected<Error> not_open(const std::string& device) { return fail("is not open", device, "open it again"); }

/// Stands where a camera could not be opened.
class NoCamera final : public Camera {
 public:
  const CameraInfo& info() const override { return info_; }
  Result<RawImage> expose(double) override { return not_open("camera"); }
  int frames_retaken() const override { return 0; }

 private:
  CameraInfo info_;
};

/// Stands where a stage could not be opened.
class NoStage final : public Stage {
 public:
  const StageInfo& info() const override { return info_; }
  Status home(std::stop_token) override { return not_open("stage"); }
  Status move_to(const Vec2&, std::stop_token) override { return not_open("stage"); }
  Result<Vec2> position() override { return not_open("stage"); }
  void halt() override {}  // there is nothing that moves

 private:
  StageInfo info_;
};

/// Opens a device and shows how that went.
template <class Open, class Show>
auto open_shown(Open open, Show show) {
  show({DeviceView::Link::opening, "", ""});
  auto device = open();
  if (device)
    show({DeviceView::Link::open, name_of((*device)->info()), ""});
  else
    show({DeviceView::Link::failed, "", device.error().message()});
  return device;
}

}  // namespace

Instruments::Instruments(const Bench& bench, const BenchDevices& devices, BenchView& view)
    : bench_(bench),
      devices_(devices),
      view_(view),
      camera_(std::make_unique<NoCamera>()),
      stage_(std::make_unique<NoStage>()) {}

Instruments::~Instruments() {
  view_.set_camera({});
  view_.set_stage({});
}

Status Instruments::open() {
  if (Status opened = open_camera(); !opened) return opened;
  return open_stage();
}

Status Instruments::reopen_camera() {
  frames_retaken_ += camera_->frames_retaken();
  std::unique_ptr<Camera> old = std::exchange(camera_, std::make_unique<NoCamera>());
  letting_go_ = std::jthread([old = std::move(old)]() mutable { old.reset(); });  // one at a time
  return open_camera();
}

Status Instruments::reopen_stage() {
  stage_ = std::make_unique<NoStage>();  // its port has one owner at a time
  return open_stage();
}

Status Instruments::open_camera() {
  auto camera = open_shown([&] { return devices_.camera(bench_.camera); },
                           [&](DeviceView now) { view_.set_camera(std::move(now)); });
  if (!camera) return tl::unexpected(camera.error());
  if (Status fits = check_picture((*camera)->info(), bench_.camera_model); !fits) {
    view_.set_camera({DeviceView::Link::failed, "", fits.error().message()});
    return fits;
  }
  camera_ = std::move(*camera);
  return {};
}

Status Instruments::open_stage() {
  auto stage = open_shown([&] { return devices_.stage(bench_.stage); },
                          [&](DeviceView now) { view_.set_stage(std::move(now)); });
  if (!stage) return tl::unexpected(stage.error());
  stage_ = std::move(*stage);
  return {};
}

}  // namespace lumifield
