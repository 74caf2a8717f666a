#include "app/views/preview_inbox.h"

#include <utility>

namespace lumifield {

PreviewInbox::PreviewInbox(QObject* parent) : QObject(parent) {}

LivePreview::Callbacks PreviewInbox::callbacks() {
  return {[this](FramePointer frame) { put(std::move(frame)); }, [this](const RendererInfo& info) { put(info); },
          [this](const Error& error) { put(error); }, [this](const PreviewProgress& progress) { put(progress); }};
}

void PreviewInbox::put(Message message) {
  const std::scoped_lock lock(mutex_);
  const bool on_its_way = !undelivered_.empty();
  if (std::holds_alternative<FramePointer>(message) || std::holds_alternative<PreviewProgress>(message))
    std::erase_if(undelivered_, [&](const Message& old) { return old.index() == message.index(); });
  undelivered_.push_back(std::move(message));
  if (!on_its_way) QMetaObject::invokeMethod(this, &PreviewInbox::deliver, Qt::QueuedConnection);
}

void PreviewInbox::deliver() {
  std::vector<Message> messages;
  {
    const std::scoped_lock lock(mutex_);
    messages.swap(undelivered_);
  }
  for (const Message& message : messages) {
    if (const auto* pointer = std::get_if<FramePointer>(&message)) emit frame(*pointer);
    if (const auto* info = std::get_if<RendererInfo>(&message)) emit ready(*info);
    if (const auto* error = std::get_if<Error>(&message)) emit failed(*error);
    if (const auto* told = std::get_if<PreviewProgress>(&message)) emit progress(*told);
  }
}

}  // namespace lumifield
