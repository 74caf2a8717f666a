#include "app/views/preview_text.h"

#include <gtest/gtest.h>

#include "tests/views/preview_frames.h"

namespace lumifield {
namespace {

TEST(PreviewText, SaysWhatThePictureHoldsAndWhatIsMissing) {
  PreviewFrame frame = preview_frame(4, 4);
  EXPECT_EQ(progress_text(frame), "37 of 63 cells · picture 42 ms · shadows: tile");
  EXPECT_EQ(missing_text(frame), "26 of 63 cells not measured yet: their light is missing");
  frame.coarse = true;
  EXPECT_EQ(progress_text(frame), "37 of 63 cells · picture 42 ms · shadows: tile · coarse");
  frame.visibility = Visibility::none;
  EXPECT_EQ(progress_text(frame), "37 of 63 cells · picture 42 ms · no shadows · coarse");
  frame.environment = true;
  EXPECT_EQ(progress_text(frame), "37 of 63 cells · picture 42 ms · no shadows · environment · coarse");
  frame.environment = false;
  frame.visibility = Visibility::published;
  frame.method.method = Method::shift_invariant;
  EXPECT_EQ(progress_text(frame),
            "37 of 63 cells · picture 42 ms · shift-invariant, weighted · shadows: cell · coarse");
  frame.method.spots.look_up = SpotLookUp::textured;
  EXPECT_EQ(progress_text(frame),
            "37 of 63 cells · picture 42 ms · shift-invariant, textured · shadows: cell · coarse");
  frame.measured = 40;
  EXPECT_EQ(missing_text(frame),
            "23 of 63 cells not measured yet: their light is missing; 3 measured cells are not in the picture yet");
  frame.measured = 63;
  EXPECT_EQ(missing_text(frame), "26 measured cells are not in the picture yet");
  frame.cells = frame.measured = 0;
  EXPECT_EQ(missing_text(frame), "none of 63 cells measured yet: the scene is dark");
  frame.cells = 63;
  EXPECT_EQ(missing_text(frame), "");
}

TEST(PreviewText, SaysTheValueOfAPixelWithItsUnit) {
  const Picture picture = *preview_frame(4, 3).radiance;
  EXPECT_EQ(pixel_text(picture, 1, 0, Quantity::radiance), "Y709 0.2 W/(m² sr)");
  EXPECT_EQ(pixel_text(picture, 2, 1, Quantity::luminance), "Y709 0.463 cd/m² · R 0.8 G 0.4 B 0.1");
  EXPECT_EQ(pixel_text(picture, 0, 2, Quantity::radiance), "background");
}

}  // namespace
}  // namespace lumifield
