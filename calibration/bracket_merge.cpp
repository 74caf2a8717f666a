#include "calibration/bracket_merge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <list>

namespace lumifield {
namespace {

/// Photosites worked on at once: structure of arrays, small enough for the first-level cache.
constexpr int block = 128;
using Lane = std::array<float, block>;

/// Share of the well below which a longer exposure counts in full, and standard deviations of distance to saturation at
/// which it no longer counts.
constexpr double fade_width = 0.2, fade_margin_sigma = 4;

/// Rate and dark, being estimates, may be negative; a variance is at least this share of the frame's fixed noise.
constexpr float least_noise = 0.25f;

/// A dark above this share of the range leaves too little of it.
constexpr double hot_share = 0.9;

/// By value, so that the loops below become vector instructions.
inline float at_least(float x, float least) { return x > least ? x : least; }
inline float at_most(float x, float most) { return x < most ? x : most; }
/// a/b, 0 where b is 0; b ≥ 0.
inline float share_of(float a, float b) { return b > 0 ? a / b : 0.0f; }

/// The constants of one exposure.
struct Exposure {
  const RawImage* light = nullptr;
  const RawImage* dark = nullptr;
  std::size_t dark_index = 0;
  float t = 0, electrons_per_dn = 0;
  float fixed = 0;  ///< read² + 1/(12 g²), of one frame
  float full = 0;   ///< electrons from black to saturation
  float fade_end = 0, fade_slope = 0;
};

/// A dark set, or none, and its frames.
struct Darks {
  const DarkModel* model = nullptr;
  std::vector<Exposure> frames;
};

struct Pass {
  std::vector<Exposure> exposures;
  float scale = 1;
  const Darks* darks = nullptr;
};

Exposure make_exposure(const RawImage& light, const DarkModel* dark, const Sensor& sensor) {
  Exposure x;
  x.light = &light;
  if (dark) {
    x.dark_index = dark->match(light).value();
    x.dark = &dark->bracket()[x.dark_index];
  }
  const double g = dn_per_electron(sensor, light);
  const double fixed = sensor.read_noise_e * sensor.read_noise_e + 1 / (12 * g * g);
  const double full = (sensor.saturation_dn - sensor.black_level_dn) / g;
  x.t = static_cast<float>(light.exposure_s);
  x.electrons_per_dn = static_cast<float>(1 / g);
  x.fixed = static_cast<float>(fixed);
  x.full = static_cast<float>(full);
  x.fade_end = static_cast<float>(full - fade_margin_sigma * std::sqrt(full + 2 * fixed));
  x.fade_slope = static_cast<float>(1 / (fade_width * full));
  return x;
}

Darks make_darks(const DarkModel* model, const Sensor& sensor) {
  Darks darks{model, {}};
  if (model)
    for (const RawImage& frame : model->bracket()) darks.frames.push_back(make_exposure(frame, nullptr, sensor));
  return darks;
}

/// The arrays of one block.
struct Lanes {
  Lanes(std::size_t exposures, std::size_t darks)
      : n(exposures), counts(exposures), weight(exposures), dark_share(darks) {}

  std::vector<Lane> n;           ///< dark-subtracted electrons, by exposure
  std::vector<Lane> counts;      ///< 1 where unsaturated, by exposure
  std::vector<Lane> weight;      ///< w_k, by exposure
  std::vector<Lane> dark_share;  ///< d(sum)/d(electrons of that dark frame)
  Lane dark_rate{}, rate{}, weight_sum{};
  Lane value{}, variance{}, valid{}, electrons{};
  Lane unused{};  ///< share of a dark frame that is not there
};

/// One block of one row, and what stays the same over it.
class BlockMerge {
 public:
  BlockMerge(const Sensor& sensor, Lanes& lanes)
      : saturation_(static_cast<float>(sensor.saturation_dn)),
        black_(static_cast<float>(sensor.black_level_dn)),
        hot_(static_cast<float>(sensor.black_level_dn + hot_share * (sensor.saturation_dn - sensor.black_level_dn))),
        lanes_(lanes) {}

  void start(std::size_t offset, int size) {
    offset_ = offset, size_ = size;
    for (Lane* lane : {&lanes_.value, &lanes_.variance, &lanes_.electrons}) lane->fill(0);
    lanes_.valid.fill(1);
    darks_ = nullptr;
  }

  void add(const Pass& pass) {
    if (pass.darks != darks_) change_darks(pass.darks);
    for (std::size_t k = 0; k < pass.exposures.size(); ++k) read(pass.exposures[k], k);
    pool(pass);
    weigh(pass, false);
    weigh(pass, true);
    accumulate(pass);
  }

  void finish(const float* factor, PhotositeSignal* out) {
    change_darks(nullptr);
    for (int i = 0; i < size_; ++i)
      out[i] = {lanes_.value[i] * factor[i], lanes_.variance[i] * factor[i] * factor[i], lanes_.valid[i],
                lanes_.electrons[i]};
  }

 private:
  /// Adds the noise of each dark frame so far once, and goes on with others.
  void change_darks(const Darks* darks) {
    for (std::size_t d = 0; darks_ && d < darks_->frames.size(); ++d) {
      const float t = darks_->frames[d].t, fixed = darks_->frames[d].fixed;
      const float* share = lanes_.dark_share[d].data();
      for (int i = 0; i < block; ++i)
        lanes_.variance[i] += share[i] * share[i] * at_least(lanes_.dark_rate[i] * t + fixed, least_noise * fixed);
    }
    darks_ = darks;
    if (!darks_) return;
    for (Lane& lane : lanes_.dark_share) lane.fill(0);
    if (darks_->model)
      std::copy_n(darks_->model->rate().begin() + static_cast<std::ptrdiff_t>(offset_), size_,
                  lanes_.dark_rate.begin());
    else
      lanes_.dark_rate.fill(0);
  }

  void read(const Exposure& x, std::size_t k) {
    float *n = lanes_.n[k].data(), *counts = lanes_.counts[k].data();
    const std::uint16_t* light = x.light->dn.data() + offset_;
    if (x.dark) {
      const std::uint16_t* dark = x.dark->dn.data() + offset_;
      for (int i = 0; i < size_; ++i) {
        const float l = light[i], d = dark[i];
        n[i] = (l - d) * x.electrons_per_dn;
        counts[i] = (l < saturation_ ? 1.0f : 0.0f) * (d < hot_ ? 1.0f : 0.0f);
      }
    } else {
      for (int i = 0; i < size_; ++i) {
        const float l = light[i];
        n[i] = (l - black_) * x.electrons_per_dn;
        counts[i] = l < saturation_ ? 1.0f : 0.0f;
      }
    }
    std::fill(n + size_, n + block, 0.0f);
    std::fill(counts + size_, counts + block, 0.0f);
  }

  /// rate = Σ n/Σ t, the best estimate where shot noise rules.
  void pool(const Pass& pass) {
    Lane& time = lanes_.weight_sum;
    time.fill(0);
    lanes_.rate.fill(0);
    for (std::size_t k = 0; k < pass.exposures.size(); ++k) {
      const float t = pass.exposures[k].t;
      const Lane &n = lanes_.n[k], &counts = lanes_.counts[k];
      for (int i = 0; i < block; ++i) lanes_.rate[i] += counts[i] * n[i], time[i] += counts[i] * t;
    }
    for (int i = 0; i < block; ++i) lanes_.rate[i] = share_of(lanes_.rate[i], time[i]);
  }

  /// rate = Σ w n/t / Σ w with weights at the rate so far; faded only in the last round, since a rate made from faded
  /// weights is no longer uncorrelated with the differences that the fade selects by.
  void weigh(const Pass& pass, bool faded) {
    Lane sum;
    sum.fill(0);
    lanes_.weight_sum.fill(0);
    for (std::size_t k = 0; k < pass.exposures.size(); ++k) {
      const Exposure& x = pass.exposures[k];
      const float frames = x.dark ? 2.0f : 1.0f, t = x.t, per_t = 1 / t, fixed = x.fixed, least = least_noise * fixed;
      const bool fades = faded && k > 0;
      const float fade_slope = fades ? x.fade_slope : 0, fade_least = fades ? 0 : 1, fade_end = x.fade_end;
      const Lane &n = lanes_.n[k], &counts = lanes_.counts[k];
      Lane& weight = lanes_.weight[k];
      for (int i = 0; i < block; ++i) {
        const float shot = lanes_.rate[i] * t, dark = lanes_.dark_rate[i] * t;
        const float fade = at_most(at_least((fade_end - shot - dark) * fade_slope, fade_least), 1.0f);
        const float noise = at_least(shot + frames * (dark + fixed), least);
        const float w = counts[i] * fade * t * t / noise;
        weight[i] = w;
        lanes_.weight_sum[i] += w;
        sum[i] += w * n[i] * per_t;
      }
    }
    for (int i = 0; i < block; ++i) lanes_.rate[i] = share_of(sum[i], lanes_.weight_sum[i]);
  }

  /// Adds scale · rate and its variance; the dark frames' share of it waits for finish().
  void accumulate(const Pass& pass) {
    const Exposure &shortest = pass.exposures.front(), &longest = pass.exposures.back();
    Lane per_weight;
    const float full_rate = shortest.full / shortest.t, per_shortest = 1 / shortest.t;
    for (int i = 0; i < block; ++i) {
      const float weight = lanes_.weight_sum[i], valid = weight > 0 ? 1.0f : 0.0f, invalid = 1 - valid;
      const float rate = valid * lanes_.rate[i] + invalid * lanes_.n[0][i] * per_shortest;
      const float sigma = invalid * pass.scale * full_rate;
      per_weight[i] = share_of(pass.scale, weight);
      lanes_.value[i] += pass.scale * rate;
      lanes_.variance[i] += sigma * sigma;
      lanes_.valid[i] *= valid;
      lanes_.electrons[i] += rate * longest.t;
    }
    for (std::size_t k = 0; k < pass.exposures.size(); ++k) {
      const Exposure& x = pass.exposures[k];
      const float t = x.t, per_t = 1 / t, fixed = x.fixed, least = least_noise * fixed;
      const Lane& weight = lanes_.weight[k];
      Lane& dark_share = x.dark ? lanes_.dark_share[x.dark_index] : lanes_.unused;
      for (int i = 0; i < block; ++i) {
        const float share = weight[i] * per_weight[i] * per_t;
        const float noise = at_least((lanes_.rate[i] + lanes_.dark_rate[i]) * t + fixed, least);
        lanes_.variance[i] += share * share * noise;
        dark_share[i] += share;
      }
    }
  }

  const Darks* darks_ = nullptr;
  float saturation_, black_, hot_;
  Lanes& lanes_;
  std::size_t offset_ = 0;
  int size_ = 0;
};

}  // namespace

double dn_per_electron(const Sensor& sensor, const RawImage& frame) {
  return sensor.gain_dn_per_e * std::pow(10.0, frame.gain / 20);
}

DarkModel::DarkModel(std::shared_ptr<const DarkSet> set, const Sensor& sensor) : set_(std::move(set)) {
  const std::size_t photosites = bracket().front().dn.size();
  std::vector<float> weight(photosites, 0.0f);
  rate_.assign(photosites, 0.0f);
  for (const RawImage& frame : bracket()) {
    const float t = static_cast<float>(frame.exposure_s);
    const float black = static_cast<float>(sensor.black_level_dn),
                saturation = static_cast<float>(sensor.saturation_dn);
    const float electrons_per_dn = static_cast<float>(1 / dn_per_electron(sensor, frame));
    for (std::size_t i = 0; i < photosites; ++i) {
      const float d = frame.dn[i], w = d < saturation ? t : 0.0f;
      rate_[i] += w * (d - black) * electrons_per_dn;
      weight[i] += w * t;
    }
  }
  for (std::size_t i = 0; i < photosites; ++i) rate_[i] = weight[i] > 0 ? rate_[i] / weight[i] : 0;

  std::uint64_t sum = 0;
  for (const std::uint16_t d : bracket().back().dn) sum += d;
  mean_dn_ = static_cast<double>(sum) / static_cast<double>(photosites);
}

std::optional<std::size_t> DarkModel::match(const RawImage& light) const {
  for (std::size_t d = 0; d < bracket().size(); ++d)
    if (std::abs(bracket()[d].exposure_s - light.exposure_s) <= 1e-3 * light.exposure_s &&
        std::abs(bracket()[d].gain - light.gain) < 1e-6)
      return d;
  return std::nullopt;
}

void merge_brackets(std::span<const WeightedBracket> brackets, const DarkModel* dark, const Sensor& sensor,
                    std::span<const float> factor, std::span<const RowSpan> rows, std::span<PhotositeSignal> out) {
  // Lay out the exposures
  std::vector<Pass> passes;
  std::list<Darks> all_darks;
  std::size_t most = 0, most_darks = 0;
  for (const WeightedBracket& b : brackets) {
    const DarkModel* own = b.dark ? b.dark : dark;
    if (all_darks.empty() || all_darks.back().model != own) all_darks.push_back(make_darks(own, sensor));
    Pass pass{{}, static_cast<float>(b.scale), &all_darks.back()};
    for (const RawImage& light : *b.bracket) pass.exposures.push_back(make_exposure(light, own, sensor));
    most = std::max(most, pass.exposures.size());
    most_darks = std::max(most_darks, pass.darks->frames.size());
    passes.push_back(std::move(pass));
  }

  // Go over the rows block by block
  Lanes lanes(most, most_darks);
  BlockMerge merge(sensor, lanes);
  const auto width = static_cast<std::size_t>(brackets.front().bracket->front().width_px);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (int begin = rows[row].begin; begin < rows[row].end; begin += block) {
      const std::size_t offset = row * width + static_cast<std::size_t>(begin);
      merge.start(offset, std::min(block, rows[row].end - begin));
      for (const Pass& pass : passes) merge.add(pass);
      merge.finish(factor.data() + offset, out.data() + offset);
    }
  }
}

}  // namespace lumifield
