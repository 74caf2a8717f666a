#include "app/views/signal_colours.h"

#include <QPalette>
#include <gtest/gtest.h>

namespace lumifield {
namespace {

TEST(SignalColours, AreReadableOnLightAndOnDark) {
  EXPECT_NEAR(contrast(Qt::black, Qt::white), 21, 1e-9);
  EXPECT_NEAR(contrast(QColor(119, 119, 119), Qt::white), 4.48, 0.01);
  for (const QColor& base : {QColor(Qt::white), QColor(239, 239, 239), QColor(45, 45, 48), QColor(Qt::black)}) {
    QPalette palette;
    palette.setColor(QPalette::Base, base);
    for (const QColor& colour :
         {fault_colour(palette), warning_colour(palette), good_colour(palette), information_colour(palette)})
      EXPECT_GE(contrast(colour, base), 4.5) << colour.name().toStdString() << " on " << base.name().toStdString();
  }
}

}  // namespace
}  // namespace lumifield
