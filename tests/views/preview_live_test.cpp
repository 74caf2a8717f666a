#include <QAction>
#include <QSignalSpy>
#include <QTest>
#include <gtest/gtest.h>

#include "app/views/preview_look_bar.h"
#include "app/views/preview_panel.h"
#include "app/views/preview_thread.h"
#include "app/views/preview_view.h"
#include "renderer/renderer.h"
#include "tests/views/preview_frames.h"

namespace lumifield {
namespace {

/// The panel on a real render thread.
class PreviewLiveTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto gl = probe_opengl(); !gl) GTEST_SKIP() << gl.error().message();
    if (const auto cl = probe_opencl(); !cl) GTEST_SKIP() << cl.error().message();
    panel.connect_to(thread, thread.live());
    panel.resize(300, 320);
    panel.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&panel));
    const std::filesystem::path file = LUMIFIELD_SOURCE_DIR "/resources/scenes/corner/scene.json";
    const auto scene = read_scene(file);
    ASSERT_TRUE(scene) << scene.error().message();
    thread.live().set_scene(*scene);
    panel.set_scene(*scene, file);
    thread.live().set_luminaire(preview_luminaire());
    panel.set_luminaire(preview_luminaire());
  }
  /// Waits for a frame that is so.
  template <class Condition>
  bool comes(Condition condition) {
    return QTest::qWaitFor([&] { return panel.view().frame() && condition(*panel.view().frame()); }, 60000);
  }

  PreviewThread thread;
  PreviewPanel panel;
};

TEST_F(PreviewLiveTest, ShowsTheLightOfEachCellInTheSizeViewAndLookAskedFor) {
  ASSERT_TRUE(comes([](const PreviewFrame& f) { return f.cells == 0 && f.total == 63; }));
  const CellImage image{4, 4, 1, std::vector<float>(16, 1.0F), {}, {}};
  thread.live().add({3, 4}, std::make_shared<const CellImage>(image));
  ASSERT_TRUE(comes([&](const PreviewFrame& f) {
    return f.cells == 1 && !f.coarse && QSize(f.shown.width_px, f.shown.height_px) == panel.view().wanted_size();
  }));
  EXPECT_GT(panel.view().frame()->average, 0);

  QTest::keyClick(&panel.view(), Qt::Key_Right);
  const Vec3 eye = panel.view().orbit().camera().position_mm;
  EXPECT_TRUE(comes([&](const PreviewFrame& f) { return !f.coarse && f.camera.position_mm == eye; }));

  panel.look_bar().false_colour_action()->trigger();
  EXPECT_TRUE(comes([](const PreviewFrame& f) { return f.look.false_colour && f.scale_top > 0; }));
}

}  // namespace
}  // namespace lumifield
