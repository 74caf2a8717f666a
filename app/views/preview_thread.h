#pragma once

#include "app/views/preview_inbox.h"

namespace lumifield {

/// The render thread of the window, with its signals on the GUI thread. Destroying it waits for the piece of work at
/// hand.
class PreviewThread : public PreviewInbox {
 public:
  explicit PreviewThread(QObject* parent = nullptr) : PreviewInbox(parent), live_(callbacks()) {}
  LivePreview& live() { return live_; }

 private:
  LivePreview live_;
};

}  // namespace lumifield
