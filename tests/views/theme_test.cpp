#include "app/views/theme.h"

#include <QApplication>
#include <QCheckBox>
#include <QStyle>
#include <algorithm>
#include <gtest/gtest.h>

#include "app/views/signal_colours.h"

namespace lumifield {
namespace {

TEST(Theme, AnUntickedBoxShowsOnDark) {
  const QString style_before = QApplication::style()->name();
  const QPalette palette_before = QApplication::palette();
  set_style();
  for (const Theme theme : {Theme::dark, Theme::light}) {
    apply(theme);
    QCheckBox box;
    box.resize(30, 30);
    const QImage image = box.grab().toImage();
    const QColor ground = QApplication::palette().color(QPalette::Window);
    double most = 1;
    for (int x = 0; x < image.width(); ++x)
      most = std::max(most, contrast(image.pixelColor(x, image.height() / 2), ground));
    EXPECT_GE(most, theme == Theme::dark ? 3 : 1.5) << qPrintable(word_of(theme));
  }
  QApplication::setStyle(style_before);
  QApplication::setPalette(palette_before);
}

}  // namespace
}  // namespace lumifield
