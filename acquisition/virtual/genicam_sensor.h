#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/virtual/genicam_pixels.h"
#include "acquisition/virtual/genicam_processing.h"
#include "acquisition/virtual/sight.h"
#include "luminaire/error.h"

namespace lumifield::virtual_bench {

struct GenicamOptions {
  std::string serial = "LF0001";        ///< at most 15 characters
  std::string pixel_format = "Mono12";  ///< the one the sensor delivers, of genicam_pixels.h
  int width_px = 1024, height_px = 768;
  bool automatics = false;              ///< on at the start, and all `leftovers` of genicam_registers.h with them
  int repeated_every = 0;               ///< each so many triggers is carried out twice
  std::vector<std::string> stuck = {};  ///< of the leftovers: keep the value of the start
};
/// Errors: pixel format unknown, serial empty or too long.
Status check(const GenicamOptions& options);
/// What the camera tells of itself, as its options have it.
std::string genicam_description(const GenicamOptions& options);

/// The registers that the description names, big-endian. Thread-safe.
class RegisterMemory {
 public:
  virtual ~RegisterMemory() = default;
  virtual void read(std::uint32_t address, std::span<std::uint8_t> bytes) const = 0;
  virtual void write(std::uint32_t address, std::span<const std::uint8_t> bytes) = 0;

  std::uint32_t get(std::uint32_t address) const;
  void set(std::uint32_t address, std::uint32_t value);
  double get_double(std::uint32_t address) const;
  void set_double(std::uint32_t address, double value);
  void set_text(std::uint32_t address, std::uint32_t size, const std::string& text);
};

/// What carries the frames away.
class FrameLink {
 public:
  virtual ~FrameLink() = default;
  virtual bool acquiring() const = 0;
  /// Changes when another stream is set up: frames of exposures before go nowhere.
  virtual std::uint64_t stream() const = 0;
  /// An exposure has ended. Returns when it is read out, or nobody wants it any more.
  virtual void send(const Exposure& exposure, std::stop_token stop) = 0;
};

/// The part of a GenICam camera that is the same on every transport: sensor, trigger and processing, acting as its
/// registers are set.
///
///     armed ── TriggerSoftware ──▶ exposing ── exposure time over and image computed ──▶ read out ──▶ armed
///
/// The stage position, exposure time and gain of a frame are those at the start of the exposure; a trigger during an
/// exposure is ignored (TriggerOverlap Off), one during readout is kept. With TriggerMode Off exposures follow each
/// other without a pause. An exposure ends without a frame when its acquisition or its stream does. Features: Width,
/// Height, OffsetX, OffsetY (even), BinningHorizontal, BinningVertical (1 … 4, means), PixelFormat, ExposureTime (µs),
/// Gain (dB), TriggerMode, TriggerSource = Software, TriggerSoftware. Each of these spoils the frames: ExposureMode
/// TriggerWidth (there is no such trigger: 20 ms), ExposureAuto, GainAuto, Gain under GainSelector DigitalAll,
/// BlackLevelAuto, BalanceWhiteAuto, BalanceRatio under BalanceRatioSelector Red and Blue, GammaEnable with Gamma,
/// LUTEnable, ReverseX, ReverseY. Thread-safe.
class GenicamSensor {
 public:
  /// Options that check() passes.
  GenicamSensor(const GenicamOptions& options, Sight sight, RegisterMemory& memory);

  /// The registers as they are when the power is switched on.
  void power_up();
  /// Exposes whenever it is triggered, to the end.
  void run(FrameLink& link, std::stop_token stop);
  /// The picture of an exposure's light, as the registers are set: `width` × `height`, to bytes.
  void read_out(Exposure exposure, int width_px, int height_px, std::span<std::uint8_t> bytes);

  /// Frozen: triggers are taken and no frame follows.
  void freeze(bool frozen) { frozen_ = frozen; }
  std::uint64_t frames_read_out() const { return frames_; }
  const GenicamPixelFormat& format() const { return format_; }

 private:
  void expose(FrameLink& link, std::stop_token stop);
  GenicamProcessing processing() const;
  std::vector<std::uint16_t> photosites(Exposure exposure, int width_px, int height_px) const;

  const GenicamOptions options_;
  const GenicamPixelFormat format_;
  const Sight sight_;
  RegisterMemory& memory_;
  std::atomic<bool> frozen_ = false;
  std::atomic<std::uint64_t> frames_ = 0;
  int triggers_ = 0;
};

}  // namespace lumifield::virtual_bench
