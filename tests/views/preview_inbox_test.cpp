#include "app/views/preview_inbox.h"

#include <QApplication>
#include <QSignalSpy>
#include <QTest>
#include <QThread>
#include <gtest/gtest.h>
#include <thread>

namespace lumifield {
namespace {

std::shared_ptr<const PreviewFrame> frame_of(int cells) {
  PreviewFrame frame;
  frame.cells = cells;
  return std::make_shared<const PreviewFrame>(frame);
}

TEST(PreviewInbox, DeliversTheLatestFrameOnTheGuiThreadAndEverythingElse) {
  PreviewInbox inbox;
  QStringList heard;
  bool elsewhere = false;
  const auto hear = [&](const QString& what) {
    heard << what;
    elsewhere |= QThread::currentThread() != QApplication::instance()->thread();
  };
  QObject::connect(&inbox, &PreviewInbox::frame, [&](const auto& frame) { hear(QString::number(frame->cells)); });
  QObject::connect(&inbox, &PreviewInbox::ready, [&](const RendererInfo& info) { hear(info.opengl.c_str()); });
  QObject::connect(&inbox, &PreviewInbox::failed, [&](const Error& error) { hear(error.what.c_str()); });

  std::jthread([&] {
    const LivePreview::Callbacks say = inbox.callbacks();
    say.ready({"llvmpipe", "", {}, {}});
    for (int cells = 1; cells < 1000; ++cells) say.frame(frame_of(cells));
    say.failed({"refused", "", "", {}});
    say.frame(frame_of(1000));
  }).join();
  EXPECT_TRUE(heard.empty());
  QApplication::processEvents();
  EXPECT_EQ(heard, QStringList({"llvmpipe", "refused", "1000"}));
  EXPECT_FALSE(elsewhere);

  inbox.callbacks().frame(frame_of(1));
  QApplication::processEvents();
  EXPECT_EQ(heard.last(), "1");
}

TEST(PreviewInbox, DeliversTheLatestProgressAndItsFrame) {
  PreviewInbox inbox;
  QList<double> shares;
  int frames = 0;
  QObject::connect(&inbox, &PreviewInbox::progress, [&](const PreviewProgress& told) { shares << told.share; });
  QObject::connect(&inbox, &PreviewInbox::frame, [&] { ++frames; });
  const LivePreview::Callbacks say = inbox.callbacks();
  PreviewProgress progress;
  for (int k = 0; k < 100; ++k) {
    progress.share = 0.01 * k;
    say.progress(progress);
    say.frame(frame_of(k));
  }
  QApplication::processEvents();
  EXPECT_EQ(shares, QList<double>({progress.share}));
  EXPECT_EQ(frames, 1);
}

TEST(PreviewInbox, LosesNothingWhileBothThreadsWork) {
  PreviewInbox inbox;
  int last = 0, failures = 0;
  bool ascending = true;
  QObject::connect(&inbox, &PreviewInbox::frame, [&](const auto& frame) {
    ascending = ascending && frame->cells > last;
    last = frame->cells;
  });
  QObject::connect(&inbox, &PreviewInbox::failed, [&] { ++failures; });
  std::jthread render([&] {
    const LivePreview::Callbacks say = inbox.callbacks();
    for (int cells = 1; cells <= 5000; ++cells) {
      say.frame(frame_of(cells));
      if (cells % 10 == 0) say.failed({"refused", "", "", {}});
    }
  });
  EXPECT_TRUE(QTest::qWaitFor([&] { return last == 5000 && failures == 500; }, 30000));
  EXPECT_TRUE(ascending);
}

}  // namespace
}  // namespace lumifield
