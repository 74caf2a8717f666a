// The chart's files without a display and without an application.

#include <QCoreApplication>
#include <QImage>
#include <cstdlib>
#include <gtest/gtest.h>

#include "app/views/study_chart.h"
#include "tests/support/dataset_folder.h"
#include "tests/support/made_up_study.h"

namespace lumifield {
namespace {

using WithoutDisplay = support::TemporaryFolder;

TEST_F(WithoutDisplay, TheChartIsWrittenAndTwiceTheSame) {
  ASSERT_EQ(std::getenv("DISPLAY"), nullptr);
  std::string first;
  for (int k = 0; k < 2; ++k) {
    const Status written = write_study_chart(test::made_up_study(), folder_);
    ASSERT_TRUE(written) << written.error().message();
    EXPECT_EQ(QCoreApplication::instance(), nullptr);
    EXPECT_FALSE(QImage(QString::fromStdString((folder_ / "study.png").string())).isNull());
    if (k == 0) first = support::contents_of(folder_);
  }
  EXPECT_EQ(support::contents_of(folder_), first);
}

}  // namespace
}  // namespace lumifield
