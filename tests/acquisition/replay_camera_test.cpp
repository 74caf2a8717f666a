#include "acquisition/cameras/replay_camera.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "acquisition/cameras/frame_folder.h"
#include "acquisition/cameras/recording_camera.h"
#include "acquisition/stage.h"
#include "tests/support/camera_test.h"

namespace lumifield {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// Every photosite tells which frame it is of.
RawImage picture(int number, int width = 6, int height = 4) {
  RawImage image;
  image.width_px = width, image.height_px = height;
  image.dn.assign(static_cast<std::size_t>(width * height), static_cast<std::uint16_t>(256 * number + 7));
  return image;
}

class ReplayCamera : public test::CameraTest {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  void list(const std::string& text) const { write("frames.csv", text); }
  /// Pictures 1 … count, as their names tell.
  void pictures(int count) const {
    for (int k = 1; k <= count; ++k) write(std::to_string(k) + ".pgm", encode_pgm(picture(k)));
  }
  CameraSettings settings() const {
    CameraSettings settings;
    settings.kind = "replay";
    settings.address = folder_;
    return settings;
  }
  /// The number of the picture that answers; 0 for none.
  static int shown(Camera& camera, double exposure_s) {
    const Result<RawImage> image = camera.expose(exposure_s);
    EXPECT_TRUE(image) << image.error().message();
    return image ? image->dn.front() / 256 : 0;
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("replay_" + std::to_string(getpid()));
};

TEST_F(ReplayCamera, AnswersByPlaceAndExposureInTurn) {
  pictures(5);
  list(
      "file,exposure_s,asked_s,gain_db,pattern,stage_x_mm,stage_y_mm\n1.pgm,0.00099,0.001,0,mono,0,0\n"
      "2.pgm,0.004,0.004,0,mono,0,0\n3.pgm,0.00099,0.001,0,mono,10,5\n4.pgm,0.00099,0.001,0,mono,0.004,0\n"
      "5.pgm,0.004,0.004,0,mono,10,5\n");
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  EXPECT_EQ(camera->info().sensor_width_px, 6);
  EXPECT_EQ(camera->info().sensor_height_px, 4);
  EXPECT_EQ(camera->frames_retaken(), 0);
  camera->tell_place({10, 5});
  const Result<RawImage> first = camera->expose(0.001);
  ASSERT_TRUE(first) << first.error().message();
  EXPECT_EQ(first->dn, picture(3).dn);
  EXPECT_EQ(first->bits, 12);
  EXPECT_EQ(first->exposure_s, 0.00099) << "what the camera reported";
  EXPECT_EQ(shown(*camera, 0.004), 5);
  camera->tell_place({0.002, 0.001});
  EXPECT_EQ(shown(*camera, 0.001), 1);
  EXPECT_EQ(shown(*camera, 0.001), 4) << "the second exposure at the place";
  EXPECT_EQ(shown(*camera, 0.001), 4) << "the last ever after";
  EXPECT_EQ(shown(*camera, 0.004), 2);
}

TEST_F(ReplayCamera, RefusesWhatIsNotRecorded) {
  pictures(2);
  list("file,exposure_s,stage_x_mm,stage_y_mm\n1.pgm,0.001,0,0\n2.pgm,0.004,10,5\n");
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  camera->tell_place({0, 0});
  for (const double exposure_s : {0.004, 0.00102, 0., -1., double(NAN), double(INFINITY)})
    EXPECT_THAT(refusal(*camera, exposure_s),
                AllOf(HasSubstr("was not recorded at (0, 0) mm; there is 0.001 s"), HasSubstr("the plan")));
  camera->tell_place({9.5, 5});
  EXPECT_THAT(
      refusal(*camera, 0.004),
      AllOf(HasSubstr("no frame was recorded at (9.5, 5) mm; the nearest, 2.pgm, at (10, 5) mm, is more than 0.1 "
                      "mm off"),
            HasSubstr("tolerance_mm")));
  camera->tell_place({NAN, 5});
  EXPECT_THAT(refusal(*camera, 0.004), HasSubstr("no frame was recorded at"));
}

TEST_F(ReplayCamera, APlaceIsAsWideAsTheBenchsToleranceLetsIt) {
  pictures(3);
  list("file,exposure_s,stage_x_mm,stage_y_mm\n1.pgm,0.001,0.3,0\n2.pgm,0.001,-0.3,0\n3.pgm,0.001,1,0\n");
  CameraSettings wide = settings();
  wide.same_place_mm = 0.6;
  const auto camera = open(wide);
  ASSERT_NE(camera, nullptr);
  camera->tell_place({0.3, 0});
  EXPECT_EQ(shown(*camera, 0.001), 1);
  EXPECT_EQ(shown(*camera, 0.001), 2) << "taken at the same place, the stage off to the other side";
  EXPECT_EQ(shown(*camera, 0.001), 2);
  camera->tell_place({1.5, 0});
  EXPECT_EQ(shown(*camera, 0.001), 3);

  StageSettings at;
  at.kind = "replay";
  at.path = folder_;
  for (const auto& [same_mm, reads] : {std::pair(0.1, Vec2(0.7, 0)), std::pair(0.6, Vec2(1, 0))}) {
    at.same_place_mm = same_mm;
    const auto stage = open_stage(at);
    ASSERT_TRUE(stage) << stage.error().message();
    ASSERT_TRUE((*stage)->move_to({0.7, 0}));
    EXPECT_EQ(*(*stage)->position(), reads);
  }
}

TEST_F(ReplayCamera, AListWithoutPlacesAnswersAScanInItsOrder) {
  pictures(3);
  list("exposure_s,file\n0.001,1.pgm\n0.004,2.pgm\n\n0.001,3.pgm\r\n");
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  camera->tell_place({1, 2});
  EXPECT_EQ(shown(*camera, 0.001), 1);
  EXPECT_THAT(refusal(*camera, 0.001),
              HasSubstr("an exposure of 0.001 s was asked for, but the next frame, 2.pgm, has 0.004 s"));
  EXPECT_EQ(shown(*camera, 0.004), 2);
  EXPECT_EQ(shown(*camera, 0.001), 3);
  EXPECT_THAT(refusal(*camera, 0.001), AllOf(HasSubstr("all 3 frames are given"), HasSubstr("use the plan")));
}

TEST_F(ReplayCamera, WithoutAPlaceItGoesRound) {
  pictures(3);
  list("file,exposure_s,stage_x_mm,stage_y_mm\n1.pgm,0.001,0,0\n2.pgm,0.004,0,0\n3.pgm,0.001,10,5\n");
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  EXPECT_EQ(shown(*camera, 0.001), 1);
  EXPECT_EQ(shown(*camera, 0.001), 3);
  EXPECT_EQ(shown(*camera, 0.001), 1);
  EXPECT_THAT(refusal(*camera, 0.002), HasSubstr("was not recorded; there is 0.001, 0.004 s"));
}

TEST_F(ReplayCamera, RefusesAFolderThatIsNone) {
  EXPECT_THAT(refusal(settings()), AllOf(HasSubstr("frames.csv: holds no frames that can be played back"),
                                         HasSubstr("lumifield scan --record")));
  CameraSettings nowhere = settings();
  nowhere.address = folder_ / "nowhere";
  EXPECT_THAT(refusal(nowhere), HasSubstr("nowhere/frames.csv"));
  const DeviceReport report = probe_camera(nowhere);
  EXPECT_FALSE(report.usable);
  EXPECT_THAT(report.reason, HasSubstr("nowhere/frames.csv"));
}

TEST_F(ReplayCamera, RefusesPicturesThatDoNotFit) {
  pictures(2);
  const std::string both = "file,exposure_s\n1.pgm,0.001\n2.pgm,0.001\n";
  list(both + "3.pgm,0.001\n");
  EXPECT_THAT(refusal(settings()), HasSubstr("3.pgm: is listed, but cannot be read; put it there"));
  list(both);
  write("2.pgm", encode_pgm(picture(2, 4, 4)));
  EXPECT_THAT(refusal(settings()), HasSubstr("2.pgm: is 4x4 pixels, 1.pgm is 6x4; take out"));
  const std::string whole = encode_pgm(picture(2));
  write("2.pgm", whole.substr(0, whole.size() - 3));
  EXPECT_THAT(refusal(settings()), HasSubstr("2.pgm: holds 57 bytes, its header says 60; it was cut off"));
  write("2.pgm", "P2\n1 1\n255\n0\n");
  EXPECT_THAT(refusal(settings()), HasSubstr("2.pgm: is no binary PGM"));
  list("file,exposure_s,pattern\n1.pgm,0.001,rggb\n");
  EXPECT_THAT(refusal(settings()), HasSubstr("another pattern of colours, the bench file says Mono12"));
  list("file,exposure_s,gain_db\n1.pgm,0.001,6\n");
  EXPECT_THAT(refusal(settings()), HasSubstr("a gain of 6 dB, the bench file says 0; set gain"));
  CameraSettings eight = settings();
  eight.pixel_format = "Mono8";
  EXPECT_THAT(refusal(eight), HasSubstr("1.pgm: has 12 bits, the bench file says Mono8"));
  eight.pixel_format = "Mono";
  EXPECT_THAT(refusal(eight), HasSubstr("no pixel format \"Mono\""));
}

TEST_F(ReplayCamera, RefusesAPictureThatWasChangedSinceItWasOpened) {
  pictures(1);
  list("file,exposure_s\n1.pgm,0.001\n");
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  write("1.pgm", encode_pgm(picture(1, 4, 4)));
  EXPECT_THAT(refusal(*camera, 0.001), HasSubstr("another size than when it was opened"));
  fs::remove(folder_ / "1.pgm");
  EXPECT_THAT(refusal(*camera, 0.001), HasSubstr("1.pgm: could not be opened"));
}

TEST_F(ReplayCamera, WhatOpeningItAgainDoesNotMendIsRefusedForGood) {
  pictures(1);
  list("file,exposure_s,stage_x_mm,stage_y_mm\n1.pgm,0.001,0,0\n");
  const auto camera = open(settings());
  ASSERT_NE(camera, nullptr);
  const auto kind = [&](const Vec2& place_mm, double exposure_s) {
    camera->tell_place(place_mm);
    const Result<RawImage> image = camera->expose(exposure_s);
    return image ? std::optional<ErrorKind>() : image.error().kind;
  };
  EXPECT_EQ(kind({0, 0}, 0.001), std::nullopt);
  EXPECT_EQ(kind({0, 0}, 0.002), ErrorKind::refused);
  EXPECT_EQ(kind({9, 0}, 0.001), ErrorKind::refused);
  std::string damaged = encode_pgm(picture(1));
  damaged.end()[-2] = '\x7f';
  write("1.pgm", damaged);
  EXPECT_EQ(kind({0, 0}, 0.001), ErrorKind::refused) << "13 bits, as a value";
  write("1.pgm", encode_pgm(picture(1, 4, 4)));
  EXPECT_EQ(kind({0, 0}, 0.001), ErrorKind::refused);
  fs::remove(folder_ / "1.pgm");
  EXPECT_EQ(kind({0, 0}, 0.001), ErrorKind::refused);
  fs::remove_all(folder_);
  EXPECT_EQ(kind({0, 0}, 0.001), ErrorKind::fault) << "the disk it is on may come back";
}

TEST(FrameList, TellsTheLineAndColumnThatIsWrong) {
  const auto refusal = [](const std::string& csv) {
    const auto frames = parse_frame_list(csv, "frames.csv");
    return frames ? "read" : frames.error().message();
  };
  EXPECT_THAT(refusal(""), HasSubstr("frames.csv, line 1: column \"\" is not known; name the columns"));
  EXPECT_THAT(refusal("file\n"), HasSubstr("column \"exposure_s\" is missing"));
  EXPECT_THAT(refusal("file,exposure_s,file\n"), HasSubstr("column \"file\" is there twice"));
  EXPECT_THAT(refusal("file,exposure_s,exposure\n"), HasSubstr("column \"exposure\" is not known"));
  EXPECT_THAT(refusal("file,exposure_s,stage_x_mm\n"), HasSubstr("one of stage_x_mm and stage_y_mm"));
  EXPECT_THAT(refusal("file,exposure_s\n"), HasSubstr("lists no frames"));
  EXPECT_THAT(refusal("file,exposure_s\na,1\nb\n"), HasSubstr("line 3: has 1 columns, the first line 2"));
  for (const char* text : {"nan", "inf", "1e999", "0.1s", "", "0x1"})
    EXPECT_THAT(refusal("file,exposure_s\na," + std::string(text) + "\n"),
                HasSubstr("line 2, exposure_s: \"" + std::string(text) + "\" is no number; give a finite number"));
  for (const char* text : {"0", "-1", "3601"})
    EXPECT_THAT(refusal("file,exposure_s\na," + std::string(text) + "\n"), HasSubstr("is out of range")) << text;
  EXPECT_THAT(refusal("file,exposure_s,pattern\na,1,RGGB\n"), HasSubstr("pattern: \"RGGB\" is no pattern"));
  EXPECT_THAT(refusal("file,exposure_s\n../a,1\n"), HasSubstr("line 2, file: leads out of the folder"));
  EXPECT_THAT(refusal("file,exposure_s\n,1\n"), HasSubstr("line 2, file: is an empty path"));
}

TEST(FrameList, ReadsWhatItWrites) {
  const ListedFrame frame{"a/b.pgm", 1.0 / 3, 0.1, -2.5, SensorPattern::gbrg, Vec2(-1e-3, 1.0 / 7)};
  const auto read = parse_frame_list(frame_list_header() + frame_list_line(frame), "frames.csv");
  ASSERT_TRUE(read) << read.error().message();
  ASSERT_EQ(read->size(), 1u);
  const ListedFrame& same = read->front();
  EXPECT_EQ(same.file, frame.file);
  EXPECT_EQ(same.exposure_s, frame.exposure_s);
  EXPECT_EQ(same.asked_s, frame.asked_s);
  EXPECT_EQ(same.gain_db, frame.gain_db);
  EXPECT_EQ(same.pattern, frame.pattern);
  EXPECT_EQ(same.stage_mm, frame.stage_mm);
}

TEST(Pgm, ReadsWhatItWritesInEveryDepth) {
  for (int bits = 1; bits <= 16; ++bits) {
    RawImage image = picture(0, 5, 3);
    image.bits = bits;
    for (std::size_t i = 0; i < image.dn.size(); ++i)
      image.dn[i] = static_cast<std::uint16_t>((i * 0x9e37 + 1) & ((1u << bits) - 1));
    image.dn[0] = static_cast<std::uint16_t>((1u << bits) - 1);
    const auto read = decode_pgm(encode_pgm(image), "a.pgm");
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->bits, bits);
    EXPECT_EQ(read->width_px, 5);
    EXPECT_EQ(read->dn, image.dn);
  }
}

TEST(Pgm, ReadsAsOthersWriteIt) {
  const auto read = decode_pgm("P5 # by hand\n# two\n2\t1 4095\n\x0f\xff\x01\x02", "a.pgm");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_THAT(read->dn, testing::ElementsAre(4095, 0x102));
}

TEST(Pgm, RefusesWhatIsNone) {
  const auto refusal = [](const std::string& bytes) {
    const auto image = decode_pgm(bytes, "a.pgm");
    return image ? "read" : image.error().message();
  };
  EXPECT_THAT(refusal(""), HasSubstr("a.pgm: is no binary PGM"));
  EXPECT_THAT(refusal("P5\n2 1 255"), HasSubstr("ends early"));
  EXPECT_THAT(refusal("P5\n2 1 255x\1\1"), HasSubstr("ends early or is none"));
  EXPECT_THAT(refusal("P5\n-2 1 255\n\1\1"), HasSubstr("size that no camera has"));
  EXPECT_THAT(refusal("P5\n99999999999 1 255\n"), HasSubstr("size that no camera has"));
  EXPECT_THAT(refusal("P5\n16384 16384 65535\n"), HasSubstr("its header says 536870933"));
  EXPECT_THAT(refusal("P5\n1 1 0\n\1"), HasSubstr("largest value that is not 1 to 65535"));
  EXPECT_THAT(refusal("P5\n1 1 255\n\1\1"), HasSubstr("holds 13 bytes, its header says 12"));
  EXPECT_THAT(refusal("P5\n1 1 4095\n\x1f\xff"), HasSubstr("a value of more than 12 bits"));
}

/// Uniform frames, counted.
class CountingCamera final : public Camera {
 public:
  const CameraInfo& info() const override { return info_; }
  void tell_place(const Vec2& stage_mm) override { told_mm = stage_mm; }
  Result<RawImage> expose(double exposure_s) override {
    if (exposure_s > 1) return fail("too long", "camera", "less");
    RawImage image = picture(++frames);
    image.exposure_s = exposure_s * 0.99;
    image.gain = 3;
    return image;
  }
  int frames_retaken() const override { return 5; }

  CameraInfo info_{"a", "b", "c", "d", 6, 4};
  int frames = 0;
  Vec2 told_mm{0, 0};
};

TEST_F(ReplayCamera, PlaysBackWhatWasRecorded) {
  const fs::path kept = folder_ / "kept";
  const auto recording = FrameRecording::create(kept);
  ASSERT_TRUE(recording) << recording.error().message();
  auto counting = std::make_unique<CountingCamera>();
  const CountingCamera& behind = *counting;
  const auto camera = record(std::move(counting), *recording);
  EXPECT_EQ(camera->info().serial, "c");
  EXPECT_EQ(camera->frames_retaken(), 5);
  EXPECT_TRUE(camera->expose(0.5)) << "of no scan, and not kept";
  camera->tell_place({1, 2});
  EXPECT_EQ(behind.told_mm, Vec2(1, 2));
  EXPECT_TRUE(camera->expose(0.5));
  EXPECT_FALSE(camera->expose(2));
  camera->tell_place({-1.0 / 3, 2});
  EXPECT_TRUE(camera->expose(0.25));
  EXPECT_EQ((*recording)->frames(), 2u);
  EXPECT_FALSE((*recording)->error());

  CameraSettings again = settings();
  again.address = kept;
  again.gain = 3;
  const auto replay = open(again);
  ASSERT_NE(replay, nullptr);
  replay->tell_place({-1.0 / 3, 2});
  const Result<RawImage> image = replay->expose(0.25);
  ASSERT_TRUE(image) << image.error().message();
  EXPECT_EQ(image->dn, picture(3).dn);
  EXPECT_EQ(image->exposure_s, 0.25 * 0.99);
  EXPECT_EQ(image->gain, 3);
  EXPECT_THAT(FrameRecording::create(kept).error().message(), HasSubstr("holds something already"));
}

TEST_F(ReplayCamera, ARecordingThatCannotBeWrittenEndsAndTheCameraGoesOn) {
  const auto recording = FrameRecording::create(folder_ / "kept");
  ASSERT_TRUE(recording) << recording.error().message();
  const auto camera = record(std::make_unique<CountingCamera>(), *recording);
  camera->tell_place({1, 2});
  EXPECT_TRUE(camera->expose(0.5));
  fs::remove_all(folder_ / "kept");
  EXPECT_TRUE(camera->expose(0.5));
  EXPECT_TRUE(camera->expose(0.5));
  EXPECT_EQ((*recording)->frames(), 1u);
  ASSERT_TRUE((*recording)->error());
  EXPECT_THAT((*recording)->error()->where, HasSubstr("000002.pgm"));
}

TEST_F(ReplayCamera, ARecordingIsGoneOnWithWhereverItEnded) {
  const fs::path kept = folder_ / "kept";
  const auto add = [&] {
    const auto recording = FrameRecording::resume(kept);
    ASSERT_TRUE(recording) << recording.error().message();
    RawImage image = picture(1);
    image.exposure_s = 0.5;
    (*recording)->add(image, 0.5, {1, 2});
    EXPECT_FALSE((*recording)->error());
  };
  const auto names = [&] {
    std::vector<std::string> files;
    const auto frames = read_frame_list(kept);
    EXPECT_TRUE(frames) << frames.error().message();
    if (frames)
      for (const ListedFrame& frame : *frames) files.push_back(frame.file);
    return files;
  };
  const auto cut_to = [&](std::size_t bytes) { fs::resize_file(kept / frame_list_name, bytes); };
  using testing::ElementsAre;
  ASSERT_TRUE(FrameRecording::create(kept));
  add();
  EXPECT_THAT(names(), ElementsAre("000001.pgm")) << "before its first frame";
  add();
  cut_to(fs::file_size(kept / frame_list_name) - 1);
  add();
  EXPECT_THAT(names(), ElementsAre("000001.pgm", "000002.pgm")) << "in a line";
  cut_to(frame_list_header().size());
  add();
  EXPECT_THAT(names(), ElementsAre("000001.pgm")) << "after the header";
  cut_to(5);
  add();
  EXPECT_THAT(names(), ElementsAre("000001.pgm")) << "in the header";

  const ListedFrame seventh{"000007.pgm", 0.5, 0.5, 0, SensorPattern::mono, Vec2(0, 0)};
  std::ofstream(kept / frame_list_name) << frame_list_header() << frame_list_line(seventh);
  add();
  EXPECT_THAT(names(), ElementsAre("000007.pgm", "000008.pgm")) << "lines that were taken out free no number";
}

TEST_F(ReplayCamera, AReplayedStageReadsAsTheRecordedOneDid) {
  pictures(1);
  list("file,exposure_s,stage_x_mm,stage_y_mm\n1.pgm,0.001,10.003,5\n1.pgm,0.001,9.98,5\n");
  StageSettings at;
  at.kind = "replay";
  at.path = folder_;
  const auto stage = open_stage(at);
  ASSERT_TRUE(stage) << stage.error().message();
  ASSERT_TRUE((*stage)->home());
  EXPECT_EQ(*(*stage)->position(), Vec2(0, 0));
  ASSERT_TRUE((*stage)->move_to({10, 5}));
  EXPECT_EQ(*(*stage)->position(), Vec2(10.003, 5));
  ASSERT_TRUE((*stage)->move_to({-20, 5.5}));
  EXPECT_EQ(*(*stage)->position(), Vec2(-20, 5.5));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ((*stage)->move_to({1, 1}, stop.get_token()).error().kind, ErrorKind::stopped);
  EXPECT_FALSE((*stage)->move_to({NAN, 1}));
  EXPECT_FALSE((*stage)->slipped_mm());
  EXPECT_TRUE(probe_stage(at).usable);

  at.check_home = true;
  EXPECT_THAT(open_stage(at).error().message(), HasSubstr("no home switches"));
  at.check_home = false;
  list("file,exposure_s\n1.pgm,0.001\n");
  EXPECT_THAT(open_stage(at).error().message(), HasSubstr("lists no places"));
  at.path = folder_ / "nowhere";
  EXPECT_FALSE(open_stage(at));
  EXPECT_THAT(probe_stage(at).reason, HasSubstr("holds no frames"));
}

}  // namespace
}  // namespace lumifield
