#include "app/session/learned_cost.h"

#include <algorithm>

namespace lumifield {

namespace {

/// Relative deviations: of a part from one piece to the next, and of a measured time.
constexpr double drift = 0.1, noise = 0.2;
constexpr double most_surprise = 3;
constexpr double least_share = 1e-3;

}  // namespace

LearnedCost::LearnedCost(double fixed_s, double rate_s)
    : fixed_s_(fixed_s),
      rate_s_(rate_s),
      least_fixed_s_(least_share * fixed_s),
      least_rate_s_(least_share * rate_s),
      fixed_variance_(fixed_s * fixed_s),
      rate_variance_(rate_s * rate_s) {}

void LearnedCost::learn(double amount, double seconds) {
  const double expected = this->seconds(amount);
  const double surprise = std::min(seconds, most_surprise * expected) - expected;

  // What was known is less sure by now.
  fixed_variance_ += drift * fixed_s_ * drift * fixed_s_;
  rate_variance_ += drift * rate_s_ * drift * rate_s_;

  // Each part takes its share of the surprise.
  const double of_fixed = fixed_variance_ + amount * covariance_;
  const double of_rate = covariance_ + amount * rate_variance_;
  const double all = of_fixed + amount * of_rate + noise * expected * noise * expected;
  fixed_s_ = std::max(fixed_s_ + of_fixed / all * surprise, least_fixed_s_);
  rate_s_ = std::max(rate_s_ + of_rate / all * surprise, least_rate_s_);
  fixed_variance_ -= of_fixed * of_fixed / all;
  rate_variance_ -= of_rate * of_rate / all;
  covariance_ -= of_fixed * of_rate / all;
}

}  // namespace lumifield
