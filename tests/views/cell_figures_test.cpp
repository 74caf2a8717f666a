#include "app/views/cell_figures.h"

#include <gtest/gtest.h>
#include <set>

#include "app/views/value_scale.h"
#include "renderer/false_colour.h"
#include "renderer/shift_invariant/constant_distance_error.h"
#include "tests/views/lamp_model.h"

namespace lumifield {
namespace {

TEST(CellFigures, EachSaysWhatItIs) {
  std::set<QString> meanings;
  for (const CellFigure figure : all_cell_figures) meanings.insert(figure_meaning(figure));
  EXPECT_EQ(meanings.size(), all_cell_figures.size());
  EXPECT_FALSE(meanings.contains(QString()));
}

TEST(CellFigures, AWideBasisIsTold) {
  LuminaireModel model;
  CellFigures figures(model);
  LuminaireGeometry geometry = lamp_geometry(3, 2, {"Y"});
  geometry.planes.separation_mm = 1e5;
  model.reset(geometry, "lamp");
  model.put(entry_of({1, 0}, warned()), flat_image(geometry, 2));
  EXPECT_LT(figures.value(CellFigure::constant_distance, {1, 0}), 0.1);
  EXPECT_EQ(figures.geometry_note({1, 0}), "");
  geometry.planes.separation_mm = 20;
  model.reset(geometry, "lamp");
  model.put(entry_of({1, 0}, warned()), flat_image(geometry, 2));
  EXPECT_NEAR(figures.value(CellFigure::constant_distance, {1, 0}),
              100 * largest_constant_distance_error(geometry, {1, 0}), 1e-12);
  EXPECT_GT(figures.value(CellFigure::constant_distance, {1, 0}), 8);
  EXPECT_TRUE(figures.geometry_note({1, 0}).contains("of the slide and the planes alone; the measurement"));
  EXPECT_TRUE(figures.summary({1, 0}).contains(figures.geometry_note({1, 0})));
}

TEST(CellFigures, TheOneThatIsNotOfTheMeasurementComesLast) {
  EXPECT_EQ(all_cell_figures.back(), CellFigure::constant_distance);
  EXPECT_TRUE(figure_meaning(CellFigure::constant_distance).startsWith("Not of the measurement"));
}

TEST(CellFigures, TheConstantDistanceErrorIsThatOfTheLuminaireThatIsThere) {
  LuminaireModel model;
  const CellFigures figures(model);
  LuminaireGeometry geometry = lamp_geometry(3, 2, {"Y"});
  geometry.planes.separation_mm = 20;
  std::set<double> seen;
  const auto is_right = [&](const char* changed) {
    model.reset(geometry, "lamp");
    for (const CellIndex cell : {CellIndex{0, 1}, CellIndex{1, 0}}) {
      model.put(entry_of(cell), flat_image(geometry, 2));
      const double wanted = 100 * largest_constant_distance_error(geometry, cell);
      EXPECT_TRUE(seen.insert(wanted).second) << changed << ": nothing is tested";
      for (int again = 0; again < 2; ++again) EXPECT_EQ(figures.value(CellFigure::constant_distance, cell), wanted);
    }
  };
  is_right("as it is");
  geometry.planes.separation_mm = 30;
  is_right("planes");
  geometry.sampling.spacing_mm *= 2;
  is_right("spacing");
  geometry.sampling.center_mm.x() += 3;
  is_right("the grid's centre");
  geometry.sampling.basis = BasisKind::box;
  is_right("basis");
  geometry.measurement.pixel_mm *= 3;
  is_right("pixels");
  geometry.measurement.center_mm.y() += 5;
  is_right("the images' centre");
}

TEST(CellFigures, SpeakInTheUnitsShown) {
  LuminaireModel model;
  CellFigures figures(model);
  EXPECT_TRUE(std::isnan(figures.value(CellFigure::total, {0, 0})));
  EXPECT_EQ(figures.summary({0, 0}), "");
  const LuminaireGeometry geometry = lamp_geometry(3, 2, {"R", "G", "B"});
  model.reset(geometry, "lamp");
  Quality quality = warned();
  quality.position_error_mm = 0.004;
  quality.drift = -0.0125;
  quality.exposures_s["positive"] = {0.0005, 0.002};
  model.put(entry_of({1, 0}, quality), flat_image(geometry, 2));
  EXPECT_EQ(figures.text(CellFigure::saturated, {1, 0}), "25 %");
  EXPECT_EQ(figures.text(CellFigure::snr, {1, 0}), "not known");
  EXPECT_EQ(figures.text(CellFigure::position, {1, 0}), "0.004 mm");
  EXPECT_EQ(figures.text(CellFigure::drift, {1, 0}), "−1.25 %");
  EXPECT_EQ(figures.value(CellFigure::total, {1, 0}), (2 + 4 + 6) * 48 * 0.25);
  EXPECT_EQ(figures.text(CellFigure::total, {1, 0}), "144 cd/m²");
  const QString summary = figures.summary({1, 0});
  EXPECT_TRUE(summary.contains("row 1, column 0")) << summary.toStdString();
  EXPECT_TRUE(summary.contains("(−7.5, 3.75) mm"));
  EXPECT_TRUE(summary.contains("saturated share 25 % above 0.1 %"));
  EXPECT_TRUE(summary.contains("Exposures of pass positive, adapted: 0.5, 2 ms")) << summary.toStdString();
  EXPECT_TRUE(figures.summary({0, 0}).endsWith("unmeasured"));
}

TEST(CellFigures, ARetakenCellIsLookedAtAgain) {
  LuminaireModel model;
  const CellFigures figures(model);
  const LuminaireGeometry geometry = lamp_geometry(2, 1);
  model.reset(geometry, "lamp");
  model.put(entry_of({0, 0}), flat_image(geometry, 1));
  EXPECT_EQ(figures.largest(0), 1);
  model.put(entry_of({0, 1}), flat_image(geometry, 7));
  EXPECT_EQ(figures.largest(0), 7);
  model.put(entry_of({0, 1}), flat_image(geometry, -3));
  EXPECT_EQ(figures.largest(0), 1);
  EXPECT_EQ(figures.value(CellFigure::total, {0, 1}), -3 * 48 * 0.25);
}

TEST(CellFigures, ScalesReachFromNothingAndDriftToBothSides) {
  LuminaireModel model;
  const CellFigures figures(model);
  const LuminaireGeometry geometry = lamp_geometry(2, 1);
  model.reset(geometry, "lamp");
  EXPECT_EQ(figures.scale(CellFigure::snr), (ValueScale{0, 1}));
  Quality quality;
  quality.median_snr = 40;
  quality.drift = -0.02;
  model.put(entry_of({0, 0}, quality), flat_image(geometry, 1));
  quality.median_snr = std::nan("");
  quality.drift = 0.01;
  model.put(entry_of({0, 1}, quality), flat_image(geometry, 1));
  EXPECT_EQ(figures.scale(CellFigure::snr), (ValueScale{0, 40}));
  EXPECT_EQ(figures.scale(CellFigure::drift), (ValueScale{-2, 2}));
}

TEST(ValueScale, MapsEndsLogarithmsAndWhatIsNotANumber) {
  EXPECT_EQ((ValueScale{-2, 2}.share(1)), 0.75);
  EXPECT_EQ((ValueScale{0, 2}.share(5)), 1);
  const ValueScale decades{0.01, 100, true};
  EXPECT_NEAR(decades.share(1), 0.5, 1e-12);
  EXPECT_EQ(decades.share(-1), 0);
  EXPECT_TRUE(std::isnan(decades.share(NAN)));
  EXPECT_EQ(colour_of({0, 1, false, true}, 0.5), qRgb(128, 128, 128));
}

TEST(ValueScale, TheFirstRowOfAnImageIsAtItsBottom) {
  const std::vector<float> values{0, 1, 2, 3, 4, NAN};
  const QImage image = colour_image(values.data(), 2, 3, {0, 4});
  const auto [r, g, b] = false_colour(0.25);
  EXPECT_EQ(image.pixel(1, 2), qRgb(r, g, b));
  EXPECT_EQ(image.pixel(0, 2), colour_of({0, 4}, 0));
  EXPECT_EQ(image.pixel(0, 0), colour_of({0, 4}, 4));
  EXPECT_EQ(image.pixel(1, 0), qRgb(128, 128, 128));
}

}  // namespace
}  // namespace lumifield
