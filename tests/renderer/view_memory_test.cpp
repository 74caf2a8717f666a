// What a view takes is bounded as a whole: receivers, and what spotlights have beside them.
#include "renderer/view_memory.h"

#include <gtest/gtest.h>

#include "renderer/shift_invariant/spot_memory.h"

namespace lumifield {
namespace {

LuminaireGeometry nine_by_seven(const std::vector<std::string>& channels) {
  LuminaireGeometry g;
  g.planes.separation_mm = 60;
  g.sampling = {BasisKind::bell, {8, 8}, 9, 7, {0, 0}};
  g.measurement = {200, 100, {1, 1}, {0, 0}};
  g.channels = channels;
  return g;
}

TEST(ViewMemory, CountsReceiversLuminairesAndWhatIsThereOnce) {
  const ViewMemory view{1000, 3, 20, 5000, 700};
  EXPECT_EQ(view.bytes(), 1000 * 3 * 20 + 3 * 5000 + 700);
  EXPECT_TRUE(check_view_memory("receivers", view, 2 * view.bytes()));
  const Status refused = check_view_memory("receivers", view, 2 * view.bytes() - 1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "receivers");
  EXPECT_NE(refused.error().remedy.find("leave shadows out"), std::string::npos);
}

TEST(ViewMemory, SpotlightsHaveADepthMapOfEachCellForEachPlacement) {
  const SpotMemory lit = spot_memory(nine_by_seven({"Y"}), {}, false, false);
  const SpotMemory shadowed = spot_memory(nine_by_seven({"Y"}), {}, true, false);
  EXPECT_EQ(lit.maps, 0);
  EXPECT_EQ(shadowed.maps, 63.0 * 192 * 192 * 4);
  EXPECT_EQ(shadowed.images, lit.images);
  EXPECT_GT(shadowed.each_receiver, lit.each_receiver);
  // A thousand lamps in a small picture.
  const ViewMemory view{64 * 48, 1000, shadowed.each_receiver, shadowed.maps, shadowed.images};
  EXPECT_GT(view.bytes(), 9.2e9);
  EXPECT_FALSE(check_view_memory("receivers", view, 16e9));
}

TEST(ViewMemory, SpotlightsImagesCountOnceByWhatATexelHas) {
  const double layer = 63.0 * 200 * 100;
  EXPECT_EQ(spot_memory(nine_by_seven({"Y"}), {}, true, true).images, layer * 4);
  EXPECT_EQ(spot_memory(nine_by_seven({"R", "G", "B"}), {}, true, true).images, layer * 16);
  EXPECT_GT(spot_memory(nine_by_seven({"Y"}), {.look_up = SpotLookUp::textured}, true, true).images,
            4.0 / 3 * layer * 4)
      << "its levels";
}

TEST(ViewMemory, AReceiverOfSpotlightsHasItsTexturesSumsAndNumbers) {
  // 2 textures, the sum and a copy of 16 bytes, its place of 4; in double 48 twice, and as the copy.
  const auto each = [](const SpotSettings& settings, bool shadows, bool glossy) {
    return spot_memory(nine_by_seven({"Y"}), settings, shadows, glossy).each_receiver;
  };
  const SpotSettings textured{.look_up = SpotLookUp::textured};
  EXPECT_EQ(each(textured, false, false), 4 * 16 + 4);
  EXPECT_EQ(each(textured, true, false), 5 * 16 + 4);
  EXPECT_EQ(each(textured, false, true), 7 * 16 + 4);
  EXPECT_EQ(each({}, false, false), 3 * 16 + 4 + 3 * 48);
  EXPECT_EQ(each({.look_up = SpotLookUp::textured, .sums = SpotSums::srgbe}, false, false), 3 * 16 + 8 + 4);
}

}  // namespace
}  // namespace lumifield
