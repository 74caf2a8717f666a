#pragma once

namespace lumifield {

/// What a piece of work takes: fixed + rate · amount seconds, both learned from the pieces done. A Kalman filter with
/// deviations relative to the values: it follows a machine that gets busy within some five pieces, tells the two parts
/// apart as soon as it has seen two amounts, and takes a lone disturbance for a tripled time. Value type.
class LearnedCost {
 public:
  /// As expected before the first. No part falls below a thousandth of this, so that it can grow again.
  LearnedCost(double fixed_s, double rate_s);

  void learn(double amount, double seconds);
  double seconds(double amount) const { return fixed_s_ + rate_s_ * amount; }

 private:
  double fixed_s_, rate_s_;
  double least_fixed_s_, least_rate_s_;
  double fixed_variance_, rate_variance_, covariance_ = 0;
};

}  // namespace lumifield
