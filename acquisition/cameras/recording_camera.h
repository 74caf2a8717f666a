#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "acquisition/camera.h"

namespace lumifield {

/// What cameras took, as a folder of frames (frame_folder.h) that can be played back. Thread-bound.
class FrameRecording {
 public:
  /// Makes the folder. Errors: one that holds something.
  static Result<std::shared_ptr<FrameRecording>> create(const std::filesystem::path& folder);
  /// Goes on with one that ended anywhere; a line that is torn is cut off. Errors: a list that no recording wrote.
  static Result<std::shared_ptr<FrameRecording>> resume(const std::filesystem::path& folder);

  /// Writes the frame and its line; both are on disk when this returns.
  void add(const RawImage& image, double asked_s, const Vec2& stage_mm);

  /// `ended` is told at once when a frame cannot be written, once, by `add` and on its thread.
  void tell(std::function<void()> ended) { ended_ = std::move(ended); }

  const std::filesystem::path& folder() const { return folder_; }
  std::size_t frames() const { return frames_; }  ///< in the folder, those of before included
  /// Why the recording ended: what could not be written first. The frames before are there.
  const std::optional<Error>& error() const { return error_; }

 private:
  explicit FrameRecording(std::filesystem::path folder) : folder_(std::move(folder)) {}
  Status take_up(std::string_view list);
  Status write(const RawImage& image, double asked_s, const Vec2& stage_mm);
  Status append(const std::string& line);

  std::filesystem::path folder_;
  std::size_t frames_ = 0, last_number_ = 0;
  std::uintmax_t list_bytes_ = 0;
  std::optional<Error> error_;
  std::function<void()> ended_;
};

/// The camera itself, but that every frame taken at a place that was told is recorded too, before it is handed on.
std::unique_ptr<Camera> record(std::unique_ptr<Camera> camera, std::shared_ptr<FrameRecording> recording);

}  // namespace lumifield
