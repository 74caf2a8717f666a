#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "luminaire/basis.h"
#include "luminaire/error.h"
#include "luminaire/geometry.h"
#include "luminaire/reader_notes.h"

namespace lumifield {

/// The bench file ("format": "lumifield-bench", version 1): which devices, how they stand, what they are calibrated to.
/// Every member that the file may leave out has its default here; `lumifield check` prints them. Value types.

struct CameraSettings {
  std::string kind = "aravis";          ///< of those in acquisition/cameras/cameras.cpp
  std::string address;                  ///< host address, id, serial or path, by kind; replay: a folder of frames
  std::string pixel_format = "Mono12";  ///< GenICam spelling
  double gain = 0;                      ///< dB; the number that it counts, of v4l2 and of a camera that tells no dB
  double readout_s = 0.02;              ///< from end of exposure to the frame in memory, for predictions
  int packet_bytes = 8192;              ///< GigE Vision stream packet; 0: the largest that passes is found
  double packet_delay_us = 0;           ///< GigE Vision: pause between two packets; with packet_bytes 0 it is found too
  int binning = 1;                      ///< aravis: columns and rows that become one; the picture is so much smaller
  int width_px = 0, height_px = 0;      ///< v4l2: of the picture; 0 = the largest that it offers
  double same_place_mm = 0.1;           ///< replay: no member of its own, but same_place_mm(bench)
};

/// Thorlabs controllers of two axes, read where the stage's kind is "apt", from its member "apt".
struct AptSettings {
  /// USB serial numbers as printed on the controllers: two, of the x and the y axis; or one, with x in its bay 1 and y
  /// in bay 2.
  std::vector<std::string> serials;
  std::string controller = "kdc101";  ///< "kdc101" | "bbd30x" | "bsc20x": units of speeds, form of status messages
  Vec2 counts_per_mm{0, 0};           ///< of the carriage's motor or encoder: 34304 MTS25, 20000 DDS220, 409600 LTS150
  Vec2 direction{1, 1};               ///< ±1: sign of the stage reading for positive counts
  Vec2 travel_mm{0, 0};               ///< from home; targets beyond are refused
};

struct StageSettings {
  std::string kind = "grbl";      ///< of those in acquisition/stages/stages.cpp
  std::string path;               ///< grbl: serial device; replay: a folder of frames
  double rapid_mm_s = 0;          ///< speed used for predictions; 0 = ask the controller. apt: set on it, too
  double acceleration_mm_s2 = 0;  ///< as the speed
  bool home = true;               ///< home before the scan
  /// Every position is come to from here: from target − approach_mm to the target, on both axes at once, so that the
  /// drive's backlash always lies on the same side. More than the backlash, and away from the home switches, as homing
  /// itself comes to its zero. [0, 0] = straight to the target.
  Vec2 approach_mm{0, 0};
  /// Look for the home switches before every dark set but the first and at the end: lost steps, which no reading shows,
  /// are found, and what was measured since the last look is measured again. With `home` only. A GRBL controller needs
  /// $20=0 and $21=0 for it, as the switches lie beyond the travel.
  bool check_home = false;
  AptSettings apt;             ///< of kind "apt"
  double same_place_mm = 0.1;  ///< replay: as that of the camera
};

/// Which of the two the stage moves.
enum class StageCarries { slide, lamp };

/// Stage reading q ↦ linear·q + origin. Carrying the slide this is the filter's centre u on plane U; carrying the lamp
/// it is the lamp's displacement, so that u = −(linear·q + origin).
struct StageToLuminaire {
  Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
  Vec2 origin_mm{0, 0};
};

/// Allowed stage readings, per axis.
struct StageLimits {
  Vec2 low_mm{0, 0}, high_mm{0, 0};
};

/// Pinhole with Brown–Conrady distortion (k1, k2, p1, p2, k3; OpenCV's order) and a radial relative illumination.
struct CameraModel {
  int width_px = 0, height_px = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< px; pixel (0, 0) has its centre at (0, 0)
  std::array<double, 5> distortion{};
  /// Bench frame (mm; the luminaire frame when nothing is displaced) → camera frame (+z forward, +y down).
  Pose pose = Pose::Identity();
  /// Relative illumination V = 1 + v1 ρ² + v2 ρ⁴ + v3 ρ⁶, ρ = tan of the undistorted field angle.
  std::array<double, 3> vignetting{};
};

/// Counts to irradiance. e⁻ in a pixel = responsivity · V · E · exposure, E the irradiance on the screen in W/m².
struct Sensor {
  double black_level_dn = 0;
  double gain_dn_per_e = 1;  ///< at Gain 0 dB; at the number that `gain` sets where that is no dB
  double read_noise_e = 0;
  double saturation_dn = 4095;                         ///< DN at or above are saturated
  std::vector<double> responsivity;                    ///< e⁻/(s · W/m²) per channel (one, or R G B)
  std::string responsivity_date, responsivity_source;  ///< empty = uncalibrated: the dataset is `relative`
};

inline constexpr std::size_t most_passes = 16;

/// One stage offset: with the stage at q + offset_mm the pass' filter stands where the first one stood at q.
struct FilterPass {
  std::string name;
  Vec2 offset_mm{0, 0};  ///< in stage coordinates
  double scale = 0;      ///< ±k of Dual, times 1/(a_x a_y): C = Σ scale·E/(a_x a_y)
};

/// How the pass before the lamp is changed. stage: all stand on one slide, and the stage goes from one to the next at
/// every cell. by_operator: each has a slide of its own, in one holder, put in by hand: the passes are the outer loop
/// of a scan (acquisition/scan/scan_plan.h). Each slide then has its filter at its offset, and all are opaque at the
/// dark offset.
enum class PassChange { stage, by_operator };

struct FilterSlide {
  BasisKind basis = BasisKind::bell;
  Vec2 spacing_mm{0, 0};
  int window = 0;  ///< of the dual, spacings
  std::vector<FilterPass> passes;
  Vec2 dark_offset_mm{0, 0};  ///< the opaque patch, in stage coordinates
  PassChange change = PassChange::stage;
};

struct Bench {
  std::string name;
  CameraSettings camera;
  StageSettings stage;
  StageCarries stage_carries = StageCarries::slide;
  StageToLuminaire stage_to_luminaire;
  StageLimits limits;
  double tolerance_mm = 0.02;
  Vec2 lamp_size_mm{0, 0};
  double separation_mm = 0;
  CameraModel camera_model;
  Sensor sensor;
  FilterSlide filter;
};

/// What the way of the stage from one cell to the next is not below, mm.
double cell_step_mm(const Bench& bench);

/// How far from each other a stage may read at the same target: twice the tolerance or 0.1 mm, whichever is more, but
/// half a cell's step at most, beyond which it would be a neighbour.
double same_place_mm(const Bench& bench);

/// The bench as far as one of its passes goes: what that pass alone measures.
Bench with_pass(const Bench& bench, int pass);

/// Displacement of the lamp, and with it of S, in the bench frame at a stage reading: linear·q + origin when the stage
/// carries the lamp, else 0.
Vec2 lamp_displacement_mm(const Bench& bench, const Vec2& stage_mm);

/// Defaults taken for absent members, and members that are not known or have no effect, are told in `notes`, one text
/// each. A relative folder of frames, in `camera.address` and `stage.path` of kind "replay", counts from the file's
/// folder, so that both can be moved together; it comes back absolute, without "." and "..".
Result<Bench> read_bench(const std::filesystem::path& file, std::vector<std::string>* notes = nullptr,
                         ReaderNotes kind = ReaderNotes::all);
/// `name` stands for the file in error messages; folders of frames stay as they are written.
Result<Bench> parse_bench(std::string_view json, std::string_view name, std::vector<std::string>* notes = nullptr,
                          ReaderNotes kind = ReaderNotes::all);
std::string to_json(const Bench& bench);

}  // namespace lumifield
