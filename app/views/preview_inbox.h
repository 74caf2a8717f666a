#pragma once

#include <QObject>
#include <memory>
#include <mutex>
#include <variant>
#include <vector>

#include "app/session/live_preview.h"

namespace lumifield {

/// What the render thread says, as signals on the GUI thread, in its order. Of frames and progress only the latest is
/// delivered: a window that is busy is not flooded. It outlives the LivePreview that it listens to.
class PreviewInbox : public QObject {
  Q_OBJECT

 public:
  explicit PreviewInbox(QObject* parent = nullptr);

  /// To be called on any thread.
  LivePreview::Callbacks callbacks();

 signals:
  void frame(const std::shared_ptr<const lumifield::PreviewFrame>& frame);
  void ready(const lumifield::RendererInfo& info);
  void failed(const lumifield::Error& error);
  void progress(const lumifield::PreviewProgress& progress);

 private:
  using FramePointer = std::shared_ptr<const PreviewFrame>;
  using Message = std::variant<FramePointer, RendererInfo, Error, PreviewProgress>;
  void put(Message message);
  void deliver();

  std::mutex mutex_;
  std::vector<Message> undelivered_;
};

}  // namespace lumifield
