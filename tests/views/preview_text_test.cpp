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
  frame.half = 12;
  EXPECT_EQ(missing_text(frame), "12 cells are shown in one pass alone: the light of the other is missing");
  frame.half = 1;
  EXPECT_EQ(missing_text(frame), "1 cell is shown in one pass alone: the light of the other is missing");
}

TEST(PreviewText, TellsMeasuredShownAndDamagedCellsApart) {
  PreviewFrame frame = preview_frame(4, 4);
  EXPECT_EQ(missing_text(frame, {40, 0}),
            "23 of 63 cells not measured yet: their light is missing; 3 measured cells are not in the picture yet");
  EXPECT_EQ(missing_text(frame, {63, 0}), "26 measured cells are not in the picture yet");
  EXPECT_EQ(missing_text(frame, {30, 0}), missing_text(frame)) << "the picture may know more";
  EXPECT_EQ(missing_text(frame, {37, 1}),
            "25 of 63 cells not measured yet: their light is missing; "
            "1 cell is damaged: its light is missing (see Notices)");
  frame.cells = 61;
  EXPECT_EQ(missing_text(frame, {61, 2}), "2 cells are damaged: their light is missing (see Notices)");
}

TEST(PreviewText, SaysWhatComes) {
  PreviewFrame frame = preview_frame(4, 4);
  PreviewProgress progress;
  progress.working = true;
  progress.share = 0.351;
  progress.left_s = 11.2;
  EXPECT_EQ(progress_text(frame, progress), "37 of 63 cells · picture 42 ms · shadows: tile · next in about 12 s");
  frame.coarse = true;
  EXPECT_TRUE(progress_text(frame, progress).endsWith(" · coarse, finer in about 12 s"));
  progress.coarse = true;
  EXPECT_TRUE(progress_text(frame, progress).endsWith(" · coarse, a finer one follows"));
  progress.coarse = false;
  progress.left_s = 130;
  EXPECT_TRUE(progress_text(frame, progress).endsWith("finer in about 3 min"));

  PreviewChoice chosen;
  EXPECT_EQ(coming_text(&frame, progress, chosen), "") << "what is shown is what is chosen";
  chosen.method = {.method = Method::mis, .samples = 200};
  EXPECT_EQ(coming_text(&frame, progress, chosen),
            "Computing mis, 200 · shadows: tile. Shown: closed-form · shadows: tile")
      << "the render thread is at something else";
  progress.asked = chosen.method;
  EXPECT_EQ(coming_text(&frame, progress, chosen),
            "Computing mis, 200 · shadows: tile: 35 %, about 3 min left. Shown: closed-form · shadows: tile");
  EXPECT_EQ(coming_text(nullptr, progress, chosen), "Computing mis, 200 · shadows: tile: 35 %, about 3 min left");
  chosen.visibility = Visibility::none;
  EXPECT_EQ(coming_text(&frame, progress, chosen),
            "Computing mis, 200 · no shadows. Shown: closed-form · shadows: tile");
}

TEST(PreviewText, SaysWhyThereIsNoPictureByWhatIsChosen) {
  const PreviewFrame frame = preview_frame(4, 4);
  PreviewProgress progress;
  progress.asked.method = Method::position_dependent_printed;
  progress.refused = Error{"lies between the planes", "receiver 7", "use closed-form", {}};
  const PreviewChoice chosen{progress.asked};
  EXPECT_EQ(coming_text(&frame, progress, chosen),
            "No picture by position-dependent-printed, 200 · shadows: tile: receiver 7: lies between the planes; use "
            "closed-form. Shown: closed-form · shadows: tile");
  EXPECT_EQ(coming_text(&frame, progress, PreviewChoice{}), "") << "the former one is chosen again";
}

TEST(PreviewText, SaysTheValueOfAPixelWithItsUnit) {
  const Picture picture = *preview_frame(4, 3).radiance;
  EXPECT_EQ(pixel_text(picture, 1, 0, Quantity::radiance), "Y709 0.2 W/(m² sr)");
  EXPECT_EQ(pixel_text(picture, 2, 1, Quantity::luminance), "Y709 0.463 cd/m² · R 0.8 G 0.4 B 0.1");
  EXPECT_EQ(pixel_text(picture, 0, 2, Quantity::radiance), "background");
}

}  // namespace
}  // namespace lumifield
