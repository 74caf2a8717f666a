#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "renderer/methods/device_method.h"
#include "renderer/study/study.h"
#include "renderer/study/study_frame.h"

namespace lumifield {

struct StudyLuminaire {
  std::string name;
  LightField light_field;
  bool of_table_1 = false;  ///< one of those that the paper's figures are made again for (synthetic_luminaire.h)
};

/// Where the study stands, 0 … 1, and what it is at; false stops it.
using StudyProgress = std::function<bool(double share, const std::string& what)>;

/// One luminaire in one scene, with all that methods are judged by: a picture to time (256×192), 1,024 stratified
/// receivers of it with their reference, and a picture for ΔE (160×120) with its reference, the closed form's kernel
/// without a level of detail. All see the same tiles. Thread-bound.
class StudyBench {
 public:
  /// References are kept in `cache` (reference_cache.h), nowhere when it is empty.
  static Result<std::unique_ptr<StudyBench>> create(StudyCamera& camera, const StudyLuminaire& luminaire,
                                                    const std::filesystem::path& cache, const StudyLook& look = {});

  /// Evaluates a method that has the luminaire's cells, `repeats` times, and judges it. The method keeps its samples.
  Result<StudyPoint> judge(DeviceMethod& method, int repeats) const;
  /// The picture for ΔE by a host form, tone-mapped as its reference is.
  Result<Picture8> small_picture(const MethodSettings& settings) const;
  const Picture8& small_reference() const { return small_reference_; }
  /// A method that is made, and given the cells.
  Result<std::unique_ptr<DeviceMethod>> make(const MethodSettings& settings) const;

  const StudyLuminaire& luminaire() const { return *luminaire_; }
  /// The luminaire's, and how the surfaces look: "bike, in shadow".
  const std::string& name() const { return name_; }
  const StudyLook& look() const { return look_; }
  const StudyFrame& frame() const { return timed_; }

 private:
  StudyBench() = default;
  Status make_references(const std::filesystem::path& cache);
  double rel_rmse(const StudyLight& light) const;
  Picture8 tone_mapped(const StudyLight& small) const;
  std::size_t channels() const { return luminaire_->light_field.geometry().channels.size(); }

  const StudyLuminaire* luminaire_ = nullptr;
  StudyLook look_;
  std::string name_;
  StudyFrame timed_, small_;
  std::vector<std::size_t> chosen_;  ///< receivers of `timed_`
  std::vector<double> reference_;    ///< of those chosen, as StudyFrame::seen
  Picture8 small_reference_;
  double white_ = 0;  ///< average radiance of the small reference, for every tone curve
};

/// Evaluates all receivers of a frame `repeats` times: their light, and the median kernel time in seconds.
Result<double> timed_evaluation(DeviceMethod& method, const StudyFrame& frame, int repeats, StudyLight& light);

}  // namespace lumifield
