#include <QApplication>
#include <gtest/gtest.h>

/// Runs the tests of the windows inside a QApplication, which outlives them all.
int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  QApplication application(argc, argv);
  QApplication::setApplicationName("lumifield-test");
  return RUN_ALL_TESTS();
}
