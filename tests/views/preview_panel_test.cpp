#include "app/views/preview_panel.h"

#include <QAction>
#include <QApplication>
#include <QCheckBox>
#include <QDoubleSpinBox>
#include <QFile>
#include <QFileDialog>
#include <QImage>
#include <QSignalSpy>
#include <QSlider>
#include <QTemporaryDir>
#include <QTest>
#include <QToolButton>
#include <cmath>
#include <gtest/gtest.h>

#include "app/views/elided_label.h"
#include "app/views/preview_look_bar.h"
#include "app/views/preview_thread.h"
#include "app/views/preview_view.h"
#include "app/views/scene_menu.h"
#include "app/views/value_spin_box.h"
#include "tests/views/preview_frames.h"

namespace lumifield {
namespace {

/// A panel of the least size it is to work at, with scene, luminaire and frame.
class PreviewPanelTest : public testing::Test {
 protected:
  PreviewPanelTest() {
    panel.resize(400, 420);
    panel.set_scene(scene(), "/scenes/corner/scene.json");
    panel.set_luminaire(preview_luminaire());
    panel.show_ready({"llvmpipe", "PoCL", {"a bright material"}, "all"});
    panel.show();
    EXPECT_TRUE(QTest::qWaitForWindowExposed(&panel));
    show(preview_frame(40, 30));
  }
  static Scene scene() {
    Scene made;
    made.name = "corner";
    made.camera = preview_camera();
    return made;
  }
  void show(PreviewFrame frame) { panel.show_frame(std::make_shared<const PreviewFrame>(std::move(frame))); }
  template <class W>
  W* child(const QString& name) {
    for (W* found : panel.findChildren<W*>())
      if (found->accessibleName() == name || found->property("text").toString() == name) return found;
    ADD_FAILURE() << "no " << name.toStdString();
    return nullptr;
  }
  QString status() { return child<ElidedLabel>("Value under the cursor, or what the picture leaves out")->text(); }
  const PreviewLook& look() { return panel.look_bar().look(); }

  PreviewPanel panel;
};

TEST_F(PreviewPanelTest, ExposureIsInStopsBySliderFieldAndActions) {
  QSignalSpy changed(&panel.look_bar(), &PreviewLookBar::lookChanged);
  const double start = PreviewLook{}.tone.exposure;
  auto* slider = child<QSlider>("Exposure, tenths of a stop");
  auto* field = child<QDoubleSpinBox>("Exposure, stops");
  slider->setFocus();
  QTest::keyClick(slider, Qt::Key_PageUp);
  EXPECT_EQ(field->value(), 1);
  EXPECT_DOUBLE_EQ(look().tone.exposure, 2 * start);
  field->selectAll();
  QTest::keyClicks(field, "-2.5");
  QTest::keyClick(field, Qt::Key_Return);
  EXPECT_EQ(slider->value(), -25);
  EXPECT_DOUBLE_EQ(look().tone.exposure, start * std::exp2(-2.5));
  EXPECT_EQ(changed.count(), 2);
  panel.look_bar().brighter_action()->trigger();
  EXPECT_DOUBLE_EQ(look().tone.exposure, start * std::exp2(-2));
}

TEST_F(PreviewPanelTest, HoldsTheAverageThatThePictureHad) {
  auto* hold = child<QCheckBox>("Hold average");
  EXPECT_EQ(look().tone.white, 0);
  QTest::mouseClick(hold, Qt::LeftButton, {}, QPoint(8, hold->height() / 2));
  const double average = panel.view().frame()->average;
  EXPECT_GT(average, 0);
  EXPECT_EQ(look().tone.white, average);
  show(preview_frame(40, 30, {5, 5, 5}));
  EXPECT_EQ(look().tone.white, average);
  hold->click();
  EXPECT_EQ(look().tone.white, 0);

  show(preview_frame(40, 30, {0, 0, 0}, {0, 0, 0}));  // dark: held as soon as there is light
  hold->click();
  EXPECT_EQ(look().tone.white, 0);
  show(preview_frame(40, 30));
  EXPECT_EQ(look().tone.white, average);

  LuminaireGeometry other = preview_luminaire();
  other.quantity = Quantity::luminance;
  panel.set_luminaire(other);
  EXPECT_EQ(look().tone.white, 0);
}

TEST_F(PreviewPanelTest, FalseColourScaleIsAutomaticOrFixedWithItsUnit) {
  auto* colours = child<QCheckBox>("False colour");
  QTest::mouseClick(colours, Qt::LeftButton, {}, QPoint(8, colours->height() / 2));
  EXPECT_TRUE(look().false_colour);
  EXPECT_EQ(look().false_colour_top, 0);
  PreviewFrame frame = preview_frame(40, 30);
  frame.scale_top = 3.2e-5;
  show(frame);
  auto* top = child<QDoubleSpinBox>("Y709 at the scale's end");
  EXPECT_FALSE(top->isEnabled());
  EXPECT_EQ(top->text(), "3.2e-05 W/(m² sr)");
  child<QCheckBox>("Fixed scale, up to")->click();
  EXPECT_DOUBLE_EQ(look().false_colour_top, 3.2e-5);
  top->selectAll();
  QTest::keyClicks(top, "12.5");
  QTest::keyClick(top, Qt::Key_Return);
  EXPECT_DOUBLE_EQ(look().false_colour_top, 12.5);
  QTest::keyClick(top, Qt::Key_Up);
  EXPECT_DOUBLE_EQ(look().false_colour_top, 13.75);
  frame.scale_top = 7;
  show(frame);
  EXPECT_DOUBLE_EQ(look().false_colour_top, 13.75);
  panel.look_bar().false_colour_action()->trigger();
  EXPECT_FALSE(colours->isChecked());
}

TEST_F(PreviewPanelTest, OffersScenesAndMarksTheOneShown) {
  panel.set_scenes({"/scenes/corner/scene.json", "/scenes/pillars/scene.json"});
  QSignalSpy chosen(&panel, &PreviewPanel::sceneChosen);
  QStringList names;
  for (QAction* action : panel.scene_menu()->actions()) names << action->text();
  EXPECT_EQ(names, QStringList({"corner", "pillars", "", "&Open scene…", "Save s&cene as…"}));
  panel.scene_menu()->actions()[1]->trigger();
  ASSERT_EQ(chosen.count(), 1);
  EXPECT_EQ(chosen.at(0).at(0).toString(), "/scenes/pillars/scene.json");
  EXPECT_FALSE(panel.scene_menu()->actions()[1]->isChecked());  // not yet shown
  panel.set_scene(scene(), "/scenes/pillars/scene.json");
  EXPECT_TRUE(panel.scene_menu()->actions()[1]->isChecked());
  EXPECT_FALSE(panel.scene_menu()->actions()[0]->isChecked());
  panel.set_scene(scene(), "/elsewhere/hall.json");
  EXPECT_EQ(panel.scene_menu()->actions()[2]->text(), "hall");
}

TEST_F(PreviewPanelTest, FramesOfTheSceneBeforeAreNotShown) {
  panel.set_scene(scene(), "/scenes/pillars/scene.json");
  show(preview_frame(40, 30));
  EXPECT_EQ(panel.view().frame(), nullptr);
  panel.show_ready({"llvmpipe", "PoCL", {}, {}});
  show(preview_frame(40, 30));
  EXPECT_NE(panel.view().frame(), nullptr);
}

TEST_F(PreviewPanelTest, SaysWhatIsLeftOutOrTheValueUnderTheCursor) {
  EXPECT_EQ(status(), "a bright material; left out: no shadows") << "as the frame has it";
  const QPointF at(panel.view().picture_rect().topLeft() + QPointF(3, 3));
  QMouseEvent move(QEvent::MouseMove, at, panel.view().mapToGlobal(at), Qt::NoButton, Qt::NoButton, Qt::NoModifier);
  QApplication::sendEvent(&panel.view(), &move);
  EXPECT_EQ(status(), "pixel 0, 0: Y709 0.2 W/(m² sr)");
  QEvent leave(QEvent::Leave);
  QApplication::sendEvent(&panel.view(), &leave);
  EXPECT_EQ(status(), "a bright material; left out: no shadows") << "as the frame has it";
}

TEST_F(PreviewPanelTest, SavesThePictureAsShownOrItsRadiance) {
  QTemporaryDir folder;
  QSignalSpy noticed(&panel, &PreviewPanel::noticed);
  const auto save = [&](const char* name) {
    const int before = static_cast<int>(noticed.count());
    panel.save_picture(folder.filePath(name).toStdString());
    EXPECT_TRUE(QTest::qWaitFor([&] { return noticed.count() > before; }, 30000));
    return noticed.last().at(0).value<OperatorNotice>();
  };
  const OperatorNotice png = save("a.png");
  EXPECT_EQ(png.level, OperatorNotice::Level::information);
  EXPECT_EQ(png.text,
            "saved " + folder.filePath("a.png") + ": 26 of 63 cells not measured yet: their light is missing");
  const QImage read(folder.filePath("a.png"));
  ASSERT_EQ(read.size(), QSize(40, 30));
  const Picture8& shown = panel.view().frame()->shown;
  EXPECT_EQ(read.pixel(39, 3), qRgb(shown.srgb[117], shown.srgb[118], shown.srgb[119]));

  EXPECT_EQ(save("a.exr").level, OperatorNotice::Level::information);
  QFile exr(folder.filePath("a.exr"));
  ASSERT_TRUE(exr.open(QIODevice::ReadOnly));
  EXPECT_TRUE(exr.readAll().contains("no shadows; 26 of 63 cells not measured yet: their light is missing"));

  EXPECT_EQ(save("a.jpg").level, OperatorNotice::Level::fault);
  EXPECT_FALSE(QFile::exists(folder.filePath("a.jpg")));
  const OperatorNotice missing = save("none/a.png");
  EXPECT_EQ(missing.level, OperatorNotice::Level::fault);
  EXPECT_TRUE(missing.text.contains("none/a.png"));
}

TEST_F(PreviewPanelTest, AsksForTheFileWithoutHoldingTheWindow) {
  QTemporaryDir folder;
  QSignalSpy noticed(&panel, &PreviewPanel::noticed);
  QAction* save = panel.panel_actions().last();
  ASSERT_TRUE(save->isEnabled());
  save->trigger();
  auto* dialog = panel.findChild<QFileDialog*>();
  ASSERT_NE(dialog, nullptr);
  dialog->setDirectory(folder.path());
  dialog->selectFile("shown");
  QMetaObject::invokeMethod(dialog, "accept");
  ASSERT_TRUE(QTest::qWaitFor([&] { return noticed.count() == 1; }, 30000));
  EXPECT_TRUE(QFile::exists(folder.filePath("shown.png")));

  panel.set_scene(scene(), "/scenes/pillars/scene.json");
  EXPECT_FALSE(save->isEnabled());
  panel.save_picture(folder.filePath("b.png").toStdString());
  EXPECT_EQ(noticed.last().at(0).value<OperatorNotice>().level, OperatorNotice::Level::fault);
}

TEST_F(PreviewPanelTest, ALateFrameOfAFormerLuminaireIsNotShown) {
  PreviewThread thread;
  panel.connect_to(thread, thread.live());
  const auto arrives = [&](int cells, std::uint64_t luminaire) {
    PreviewFrame frame = preview_frame(40, 30);
    frame.cells = cells;
    frame.luminaire = luminaire;
    thread.callbacks().frame(std::make_shared<const PreviewFrame>(std::move(frame)));
    QApplication::processEvents();
  };
  thread.live().set_luminaire(preview_luminaire());
  arrives(11, 1);
  EXPECT_EQ(panel.view().frame()->cells, 11);
  thread.live().set_luminaire(preview_luminaire());
  panel.set_luminaire(preview_luminaire());
  arrives(12, 1);
  EXPECT_EQ(panel.view().frame(), nullptr);
  arrives(1, 2);
  ASSERT_NE(panel.view().frame(), nullptr);
  EXPECT_EQ(panel.view().frame()->cells, 1);
}

TEST_F(PreviewPanelTest, EveryControlSaysWhatItIs) {
  for (QAction* action : panel.panel_actions())
    EXPECT_FALSE(action->toolTip().isEmpty()) << action->text().toStdString();
  for (QWidget* control : panel.findChildren<QWidget*>()) {
    if (control->focusPolicy() == Qt::NoFocus || control->parentWidget()->inherits("QAbstractSpinBox")) continue;
    if (control == &panel.view()) continue;  // its tooltip would cover the picture
    EXPECT_FALSE(control->toolTip().isEmpty()) << control->metaObject()->className();
    EXPECT_FALSE(control->accessibleName().isEmpty() && control->property("text").toString().isEmpty());
  }
  EXPECT_LE(panel.minimumSizeHint().width(), 400);
}

TEST_F(PreviewPanelTest, TabGoesFromTheToolsToThePicture) {
  QWidget* first = child<QToolButton>("Scene");
  first->setFocus();
  QStringList seen;
  for (int k = 0; k < 20 && panel.focusWidget() != &panel.view(); ++k) {
    QWidget* at = panel.focusWidget();
    ASSERT_NE(at, nullptr);
    seen << (at->accessibleName().isEmpty() ? at->property("text").toString() : at->accessibleName());
    QTest::keyClick(at, Qt::Key_Tab);
  }
  EXPECT_EQ(seen,
            QStringList({"Scene", "Lamps", "False colour", "Reset", "Save…", "Exposure, tenths of a stop",
                         "Exposure, stops", "Hold average", "Method that computes the light", "What casts shadows"}));
}

TEST(ValueSpinBox, TakesNumbersOfAnyMagnitudeAndNothingElse) {
  ValueSpinBox box;
  box.setSuffix(" cd/m²");
  const auto state = [&](QString text) {
    int position = 0;
    return box.validate(text, position);
  };
  EXPECT_EQ(state("1.5e-7 cd/m²"), QValidator::Acceptable);
  EXPECT_EQ(state("1e cd/m²"), QValidator::Intermediate);
  EXPECT_EQ(state("0"), QValidator::Intermediate);
  EXPECT_EQ(state("-3"), QValidator::Intermediate);
  EXPECT_EQ(state("1e99"), QValidator::Intermediate);
  EXPECT_EQ(state("1 lx cd/m²"), QValidator::Invalid);
  for (const double value : {1.5e-7, 3.0, 250000.0}) {
    box.setValue(value);
    EXPECT_DOUBLE_EQ(box.valueFromText(box.text()), value);
  }
}

}  // namespace
}  // namespace lumifield
