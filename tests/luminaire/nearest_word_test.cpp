#include "luminaire/nearest_word.h"

#include <gtest/gtest.h>
#include <vector>

namespace lumifield {
namespace {

TEST(NearestWord, IsThatWithTheFewestWrongLetters) {
  const std::vector<std::string> words{"", "adres", "addresses", "Address", "readdressed", std::string(1'000'000, 'a')};
  EXPECT_EQ(nearest_word("address", words), "Address");
  EXPECT_EQ(nearest_word("adress", words), "adres");
  EXPECT_EQ(nearest_word("addresse", words), "addresses");
  EXPECT_EQ(nearest_word("gain", words), std::nullopt);
  EXPECT_EQ(nearest_word("address", {}), std::nullopt);
}

TEST(NearestWord, MayHaveAThirdOfTheLettersWrongAndOne) {
  const std::vector<std::string> words{"abcdxx", "abcxxx"};
  EXPECT_EQ(nearest_word("abcdef", words), "abcdxx");
  EXPECT_EQ(nearest_word("abcdef", std::span(words).subspan(1)), "abcxxx");
  EXPECT_EQ(nearest_word("abxyef", std::span(words).subspan(1)), std::nullopt);
  const std::vector<std::string> equals{"fz", "fy"};
  EXPECT_EQ(nearest_word("fx", equals), "fz") << "the first of equals";
}

}  // namespace
}  // namespace lumifield
