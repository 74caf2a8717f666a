#include "app/views/study_chart.h"

#include <QGraphicsPathItem>
#include <QGraphicsSimpleTextItem>
#include <QGraphicsTextItem>
#include <QGraphicsView>
#include <QHelpEvent>
#include <QImage>
#include <QScrollBar>
#include <QTemporaryDir>
#include <QTest>
#include <QToolTip>
#include <QXmlStreamReader>
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>

#include "app/views/signal_colours.h"
#include "app/views/study_marks.h"
#include "app/views/study_plot_item.h"
#include "app/views/theme.h"
#include "tests/support/dataset_folder.h"
#include "tests/support/made_up_study.h"

namespace lumifield {
namespace {

/// CIELAB of a colour as seen with all cones, or without those for red, green or blue (Machado, Oliveira, Fernandes
/// 2009, severity 1).
std::array<double, 3> lab_as_seen(const QColor& colour, int missing) {
  constexpr double seen[4][3][3] = {
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
      {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}},
      {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}},
      {{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}};
  const auto linear = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
  const double rgb[3] = {linear(colour.redF()), linear(colour.greenF()), linear(colour.blueF())};
  double s[3];
  for (int i = 0; i < 3; ++i) {
    s[i] = 0;
    for (int j = 0; j < 3; ++j) s[i] += seen[missing][i][j] * rgb[j];
    s[i] = std::clamp(s[i], 0.0, 1.0);
  }
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  const double x = f((0.4124 * s[0] + 0.3576 * s[1] + 0.1805 * s[2]) / 0.95047);
  const double y = f(0.2126 * s[0] + 0.7152 * s[1] + 0.0722 * s[2]);
  const double z = f((0.0193 * s[0] + 0.1192 * s[1] + 0.9505 * s[2]) / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

/// Which of 100×100 places in its bounds, of the same size for all, a mark fills.
std::vector<bool> filled(const QPainterPath& mark) {
  constexpr int side = 100;
  const QRectF bounds = mark.boundingRect();
  std::vector<bool> inside;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i)
      inside.push_back(mark.contains(bounds.topLeft() +
                                     QPointF((i + 0.5) / side * bounds.width(), (j + 0.5) / side * bounds.height())));
  return inside;
}

/// Share of the places that one of two marks fills and the other does not.
double unlike(const QPainterPath& a, const QPainterPath& b) {
  const std::vector<bool> left = filled(a), right = filled(b);
  int unlike = 0;
  for (std::size_t k = 0; k < left.size(); ++k) unlike += left[k] != right[k];
  return static_cast<double>(unlike) / static_cast<double>(left.size());
}

TEST(StudyMarks, ShapesDifferWhateverTheirSize) {
  EXPECT_EQ(unlike(method_mark(Method::mis, 9), method_mark(Method::mis, 10.35)), 0) << "no other shape";
  for (const MethodInfo& a : methods())
    for (const MethodInfo& b : methods())
      if (a.method < b.method) {
        EXPECT_GT(unlike(method_mark(a.method, 9), method_mark(b.method, 9)), 0.08) << a.name << " and " << b.name;
      }
}

TEST(StudyMarks, MethodsAreToldApartByColourAndByShape) {
  for (const Theme theme : {Theme::light, Theme::dark}) {
    const QPalette palette = palette_of(theme);
    EXPECT_GE(contrast(quiet_colour(palette), palette.color(QPalette::Base)), 4.5);
    for (const MethodInfo& a : methods()) {
      EXPECT_GE(contrast(method_colour(a.method, palette), palette.color(QPalette::Base)), 3) << a.name;
      for (const MethodInfo& b : methods()) {
        if (a.method == b.method) continue;
        for (int missing = 0; missing < 4; ++missing) {
          const auto p = lab_as_seen(method_colour(a.method, palette), missing);
          const auto q = lab_as_seen(method_colour(b.method, palette), missing);
          EXPECT_GE(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]), 20) << a.name << " and " << b.name;
        }
      }
    }
  }
}

/// The chart in a window of its own.
struct Shown {
  StudyChart chart;
  explicit Shown(const Study& study, const QSize& size = {1000, 460}) {
    chart.set_study(study);
    chart.resize(size);
    chart.show();
    EXPECT_TRUE(QTest::qWaitForWindowExposed(&chart));
  }
  QGraphicsScene& scene() { return *chart.view().scene(); }
  /// Marks and arrows whose tooltip holds a text.
  std::vector<QGraphicsItem*> marks(const QString& text) {
    std::vector<QGraphicsItem*> found;
    for (QGraphicsItem* item : scene().items())
      if (dynamic_cast<QGraphicsPathItem*>(item) && item->toolTip().contains(text)) found.push_back(item);
    return found;
  }
  std::vector<QGraphicsSimpleTextItem*> texts(const QString& start) {
    std::vector<QGraphicsSimpleTextItem*> found;
    for (QGraphicsItem* item : scene().items())
      if (auto* text = dynamic_cast<QGraphicsSimpleTextItem*>(item); text && text->isVisible())
        if (text->text().startsWith(start)) found.push_back(text);
    return found;
  }
};

Study two_points() {
  Study study;
  study.points = {{Method::closed_form, "bike", 4, 10, 0.1, 1, "d", 256, 192},
                  {Method::closed_form, "bike", 8, 100, 0.01, 1, "d", 256, 192}};
  return study;
}

TEST(StudyChart, APointStandsWhereTheAxesSay) {
  Study study = two_points();
  study.points.push_back({Method::closed_form, "bike", 6, std::sqrt(1000.0), std::sqrt(0.001), 1, "d", 256, 192});
  Shown shown(study);
  const auto at = [&](const char* cost) { return shown.marks(cost).at(0)->scenePos(); };
  const QPointF left = at("T = 4"), middle = at("T = 6"), right = at("T = 8");
  EXPECT_GT(right.x() - left.x(), 500);
  EXPECT_GT(right.y() - left.y(), 200);
  EXPECT_NEAR(middle.x(), (left.x() + right.x()) / 2, 0.5);
  EXPECT_NEAR(middle.y(), (left.y() + right.y()) / 2, 0.5);
  // The line that Qt draws passes through the mark that is drawn here.
  const QImage image = shown.chart.grab().toImage();
  const QPointF between = (middle + right) / 2;
  const QColor line = method_colour(Method::closed_form, shown.chart.palette());
  bool met = false;
  for (int dy = -1; dy <= 1; ++dy) {
    const QColor pixel = image.pixelColor(QPoint(qRound(between.x()), qRound(between.y()) + dy));
    met = met || std::abs(pixel.red() - line.red()) + std::abs(pixel.blue() - line.blue()) < 60;
  }
  EXPECT_TRUE(met);
}

TEST(StudyChart, ExactPointsStandAtTheLowerEdgeWithAnArrowAndAreNamed) {
  Study study = two_points();
  study.points.push_back({Method::closed_form, "bike", 0, 400, 3e-8, 0, "d", 256, 192});
  study.points.push_back({Method::reference, "bike", 0, 900, 0, 0, "host", 256, 192});
  Shown shown(study);
  const auto mark = shown.marks("closed-form, exact");
  ASSERT_EQ(mark.size(), 2U);  // mark and arrow
  const double lower = std::max(mark[0]->scenePos().y(), mark[1]->scenePos().y());
  EXPECT_GT(lower, shown.marks("T = 8").at(0)->scenePos().y());
  EXPECT_EQ(shown.marks("reference").size(), 2U);
  EXPECT_EQ(shown.texts("exact: 3·10").size(), 1U);
  EXPECT_EQ(shown.texts("exact").size(), 2U);
}

TEST(StudyChart, NamesCoverNeitherEachOtherNorMarks) {
  for (const QSize& size : {QSize(1000, 460), QSize(420, 900), QSize(340, 300)}) {
    Shown shown(test::made_up_study(), size);
    std::vector<QRectF> names;
    for (const char* start : {"T = ", "K = ", "exact"})
      for (const auto* text : shown.texts(start)) names.push_back(text->sceneBoundingRect());
    EXPECT_GE(names.size(), 12U);
    for (std::size_t a = 0; a < names.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) EXPECT_FALSE(names[a].intersects(names[b])) << a << " and " << b;
      for (const QGraphicsItem* mark : shown.marks("relative RMSE"))
        EXPECT_FALSE(names[a].adjusted(2, 2, -2, -2).contains(mark->scenePos()));
      EXPECT_TRUE(shown.scene().sceneRect().contains(names[a]));
    }
  }
}

TEST(StudyChart, PlotsWrapToTheWidthAndScroll) {
  Shown shown(test::made_up_study(), {1000, 500});
  const auto places = [&] {
    std::array<QPointF, 3> all;
    const char* names[] = {"bike", "car1", "car2"};
    for (std::size_t k = 0; k < 3; ++k) all[k] = shown.texts(names[k]).at(0)->scenePos();
    return all;
  };
  EXPECT_EQ(places()[0].y(), places()[2].y());
  EXPECT_FALSE(shown.chart.view().verticalScrollBar()->isVisible());
  shown.chart.resize(400, 500);
  EXPECT_TRUE(QTest::qWaitFor([&] { return places()[1].y() > places()[0].y(); }));
  EXPECT_EQ(places()[0].x(), places()[2].x());
  EXPECT_TRUE(QTest::qWaitFor([&] { return shown.chart.view().verticalScrollBar()->isVisible(); }));
  EXPECT_LE(shown.scene().sceneRect().width(), 400);
}

TEST(StudyChart, AMarksTooltipTellsItsPointAndIsNoMarkup) {
  Study study = two_points();
  study.points[0].device = "<b>bold</b>";
  Shown shown(study);
  QGraphicsView& view = shown.chart.view();
  const QPoint at = view.mapFromScene(shown.marks("T = 4").at(0)->scenePos());
  QHelpEvent help(QEvent::ToolTip, at, view.viewport()->mapToGlobal(at));
  QCoreApplication::sendEvent(view.viewport(), &help);
  EXPECT_TRUE(QTest::qWaitFor([] { return QToolTip::isVisible(); }));
  const QString text = QToolTip::text();
  for (const char* part : {"closed-form, T = 4", "10 %", "10 ms", "256 × 192 pixels", "&lt;b&gt;bold"})
    EXPECT_TRUE(text.contains(part)) << part << " in " << text.toStdString();
  QToolTip::hideText();
}

TEST(StudyChart, SaysWhatItLeavesOutAndReadsItsPointsAloud) {
  Study study = two_points();
  study.points.push_back(study.points[0]);
  study.points.back().width_px = 1024;
  Shown shown(study);
  bool told = false;
  for (const QGraphicsItem* item : shown.scene().items())
    if (const auto* text = dynamic_cast<const QGraphicsTextItem*>(item))
      told = told || text->toPlainText().contains("Not drawn: 1 at another picture size");
  EXPECT_TRUE(told);
  const QString spoken = shown.chart.view().accessibleDescription();
  EXPECT_EQ(spoken.count('\n'), 1);
  EXPECT_TRUE(spoken.startsWith("bike, closed-form, T = 4: relative RMSE 10 %, 10 ms"));
}

TEST(StudyChart, ExtremeFiguresAreLeftOutWithTheirNumberAndTheOthersStayWhereTheyWere) {
  Study study = two_points();
  Shown sound(study);
  const QPointF before = sound.marks("T = 4").at(0)->scenePos();
  for (const double extreme : {-1.0, 1e300, 1.7e308}) {
    study.points.push_back({Method::closed_form, "bike", 16, extreme, 0.1, extreme, "d", 256, 192});
    study.points.push_back({Method::closed_form, "bike", 16, 20, extreme, 1e-300, "d", 256, 192});
  }
  study.points.push_back({Method::closed_form, "bike", 1e12, 1e-300, 0.1, 1e300, "d", 256, 192});
  Shown shown(study);
  EXPECT_EQ(shown.marks("relative RMSE").size(), 2U);
  const QPointF after = shown.marks("T = 4").at(0)->scenePos();
  EXPECT_NEAR(after.x(), before.x(), 0.5);
  bool told = false;
  for (const QGraphicsItem* item : shown.scene().items())
    if (const auto* text = dynamic_cast<const QGraphicsTextItem*>(item))
      told = told || text->toPlainText().contains("Not drawn: 7 outside 1·10⁻⁶ to 1·10⁹ ms or above 100000 %");
  EXPECT_TRUE(told);
}

TEST(StudyChart, ThatFillsTheWholeRangeHasLegibleAxes) {
  Study study;
  study.points = {{Method::closed_form, "bike", 2, least_time_ms, largest_error_percent / 100, 1, "d", 256, 192},
                  {Method::closed_form, "bike", 4, largest_time_ms, 1e-4, 1, "d", 256, 192}};
  Shown shown(study);
  const auto at = [&](const char* cost) { return shown.marks(cost).at(0)->scenePos(); };
  EXPECT_GT(at("T = 4").x() - at("T = 2").x(), 500);
  EXPECT_GT(at("T = 4").y() - at("T = 2").y(), 200);
  EXPECT_FALSE(shown.chart.grab().toImage().isNull());
}

TEST(StudyChart, FollowsTheTheme) {
  Shown shown(two_points());
  apply(Theme::dark);
  EXPECT_TRUE(QTest::qWaitFor([&] { return shown.scene().backgroundBrush().color().lightness() < 100; }));
  EXPECT_GT(shown.texts("bike").at(0)->brush().color().lightness(), 150);
  apply(Theme::light);
  EXPECT_TRUE(QTest::qWaitFor([&] { return shown.scene().backgroundBrush().color() == Qt::white; }));
}

TEST(StudyChart, AnEmptyStudyIsDrawn) {
  Shown shown({});
  EXPECT_TRUE(shown.texts("").empty());
}

using StudyChartFiles = support::TemporaryFolder;

TEST_F(StudyChartFiles, AreASoundSvgAndAPngTwiceAsFine) {
  ASSERT_TRUE(write_study_chart(test::made_up_study(), folder_));
  const QImage png(QString::fromStdString((folder_ / "study.png").string()));
  EXPECT_EQ(png.width(), 2 * 1260);
  EXPECT_EQ(png.pixelColor(2, 2), QColor(Qt::white));
  QXmlStreamReader svg(QByteArray::fromStdString(support::read_text(folder_ / "study.svg")));
  int texts = 0;
  QString all;
  while (!svg.atEnd())
    if (svg.readNext() == QXmlStreamReader::StartElement && svg.name() == QStringLiteral("text")) {
      ++texts;
      all += svg.readElementText() + "\n";
    }
  EXPECT_FALSE(svg.hasError()) << svg.errorString().toStdString();
  EXPECT_GT(texts, 50);
  for (const char* part :
       {"bike", "car2", "position-dependent-printed", "time, ms", "relative RMSE, %", "0.01", "1000"})
    EXPECT_TRUE(all.contains(part)) << part;
}

TEST_F(StudyChartFiles, AFolderThatIsNotThereIsNamed) {
  const Status written = write_study_chart(two_points(), folder_ / "none");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message().find("none/study.svg"), std::string::npos);
}

}  // namespace
}  // namespace lumifield
