// Faults of the disk and deaths of the program, at every system call of a scan.

#include <cerrno>
#include <cstdarg>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include "luminaire/dataset.h"
#include "luminaire/file_io.h"
#include "tests/support/dataset_folder.h"

namespace {

/// Called before each system call below; what it returns, unless 0, is the errno with which the call fails.
std::function<int(const char* call)> before_call;
/// Lets each write come in two halves.
bool short_writes = false;
bool inside = false;

int injected(const char* call) {
  if (!before_call || inside) return 0;
  inside = true;
  const int code = before_call(call);
  inside = false;
  return code;
}

template <class Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

template <class Function, class... Arguments>
auto call(const char* name, Arguments... arguments) {
  if (const int code = injected(name)) {
    errno = code;
    return static_cast<decltype(real<Function>(name)(arguments...))>(-1);
  }
  return real<Function>(name)(arguments...);
}

}  // namespace

// The program's own definitions stand before the C library's.
extern "C" {
int fsync(int fd) { return call<int (*)(int)>("fsync", fd); }
int ftruncate(int fd, off_t length) noexcept { return call<int (*)(int, off_t)>("ftruncate", fd, length); }
int rename(const char* from, const char* to) noexcept {
  return call<int (*)(const char*, const char*)>("rename", from, to);
}
int renameat2(int a, const char* from, int b, const char* to, unsigned flags) noexcept {
  return call<int (*)(int, const char*, int, const char*, unsigned)>("renameat2", a, from, b, to, flags);
}
int mkdir(const char* path, mode_t mode) noexcept { return call<int (*)(const char*, mode_t)>("mkdir", path, mode); }
int unlink(const char* path) noexcept { return call<int (*)(const char*)>("unlink", path); }
ssize_t write(int fd, const void* data, size_t n) {
  if (short_writes && !inside && n > 1) n /= 2;
  return call<ssize_t (*)(int, const void*, size_t)>("write", fd, data, n);
}
int open(const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = (flags & O_CREAT) ? va_arg(list, mode_t) : 0;
  va_end(list);
  return call<int (*)(const char*, int, mode_t)>("open", path, flags, mode);
}
}

namespace lumifield {
namespace {

namespace fs = std::filesystem;
using support::cell_image;
using support::contents_of;
using support::read_text;
using support::write_text;
using testing::HasSubstr;

class DatasetFault : public support::TemporaryFolder {
 protected:
  ~DatasetFault() override { stop(); }
  void stop() {
    before_call = nullptr;
    short_writes = false;
  }
  Result<DatasetWriter> create(const fs::path& folder) const {
    return DatasetWriter::create(folder, {"lamp", geometry_, {}, "{}"});
  }
  /// A scan of the cells (0, 0) … (0, cells − 1).
  void scan(const fs::path& folder, int cells) const {
    Result<DatasetWriter> writer = create(folder);
    ASSERT_TRUE(writer) << writer.error().message();
    for (int k = 0; k < cells; ++k) ASSERT_TRUE(add(*writer, k));
  }
  Status add(DatasetWriter& writer, int column) const {
    const auto entry = writer.add({0, column}, cell_image(geometry_, static_cast<unsigned>(column)), {1.0 * column, 0});
    return entry ? Status{} : Status(tl::unexpected(entry.error()));
  }
  /// Takes the missing ones of (0, 0) … (0, 2) and closes.
  void finish(const fs::path& folder) const {
    Result<DatasetWriter> writer = DatasetWriter::resume(folder, geometry_);
    ASSERT_TRUE(writer) << writer.error().message();
    for (int k = 0; k < 3; ++k) {
      bool done = false;
      for (const CellEntry& entry : writer->manifest().cells) done = done || entry.cell == CellIndex{0, k};
      if (done) continue;
      ASSERT_TRUE(add(*writer, k));
    }
    ASSERT_TRUE(writer->close());
  }
  std::string uninterrupted() const {
    scan(folder_ / "reference.lumi", 0);
    finish(folder_ / "reference.lumi");
    return contents_of(folder_ / "reference.lumi");
  }
  void expect_cells(const fs::path& folder, int cells) const {
    const Result<Dataset> read = read_dataset(folder);
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_GE(read->light_field.coverage().measured, cells);
    for (int k = 0; k < cells; ++k) {
      ASSERT_TRUE(read->light_field.cell({0, k}));
      EXPECT_EQ(read->light_field.cell({0, k})->value, cell_image(geometry_, static_cast<unsigned>(k)).value);
    }
  }
  int temporaries() const {
    int count = 0;
    for (const auto& each : fs::recursive_directory_iterator(folder_))
      count += each.path().extension() == ".tmp" || each.path().extension() == ".unfinished";
    return count;
  }
  LuminaireGeometry geometry_ = support::geometry(3, 1, 4, 3, {"Y"});
};

constexpr int faults[] = {ENOSPC, EIO, EROFS, EACCES};

/// Runs `operation` with the k-th call failing, k = 0, 1, …, until none fails. `undone` looks at what is left.
template <class Operation, class Undone>
int fail_each_call(Operation operation, Undone undone) {
  for (int k = 0;; ++k) {
    int calls = 0;
    std::string failed;
    const int code = faults[k % 4];
    // The names that are removed beforehand are usually not there.
    before_call = [&](const char* call) {
      if (std::strcmp(call, "unlink") == 0 || calls++ != k) return 0;
      failed = call;
      return code;
    };
    const Status done = operation(k);
    before_call = nullptr;
    if (failed.empty()) {
      EXPECT_TRUE(done) << done.error().message();
      return k;
    }
    EXPECT_FALSE(done) << "call " << k << ", " << failed;
    if (done) return -1;
    EXPECT_THAT(done.error().message(), HasSubstr(std::strerror(code))) << failed;
    EXPECT_FALSE(done.error().remedy.empty());
    undone(k);
  }
}

TEST_F(DatasetFault, AFailedCreateLeavesNothing) {
  const auto operation = [&](int) {
    const auto writer = create(folder_ / "lamp.lumi");
    return writer ? Status{} : Status(tl::unexpected(writer.error()));
  };
  const int calls = fail_each_call(operation, [&](int k) { EXPECT_TRUE(fs::is_empty(folder_)) << "call " << k; });
  EXPECT_GE(calls, 8);
}

TEST_F(DatasetFault, AFailedAddLeavesTheDatasetAsItWas) {
  const std::string reference = uninterrupted();
  for (const int before : {0, 1}) {
    const fs::path dataset = folder_ / ("lamp" + std::to_string(before) + ".lumi");
    scan(dataset, before);
    Result<DatasetWriter> writer = DatasetWriter::resume(dataset, geometry_);
    ASSERT_TRUE(writer);
    const std::string journal = read_text(dataset / "journal.jsonl");
    const auto undone = [&](int k) {
      EXPECT_EQ(temporaries(), 0) << "call " << k;
      EXPECT_EQ(read_text(dataset / "journal.jsonl"), journal) << "call " << k;
      const auto files = std::distance(fs::directory_iterator(dataset / "cells"), fs::directory_iterator());
      EXPECT_EQ(files, before) << "call " << k;
      expect_cells(dataset, before);
    };
    EXPECT_GE(fail_each_call([&](int) { return add(*writer, before); }, undone), 8);
    writer = fail("", "");
    finish(dataset);
    EXPECT_EQ(contents_of(dataset), reference);
  }
}

TEST_F(DatasetFault, AFailedCloseLosesNothingAndCanBeRepeated) {
  const std::string reference = uninterrupted();
  const fs::path dataset = folder_ / "lamp.lumi";
  scan(dataset, 3);
  Result<DatasetWriter> writer = DatasetWriter::resume(dataset, geometry_);
  ASSERT_TRUE(writer);
  const auto undone = [&](int k) {
    EXPECT_EQ(temporaries(), 0) << "call " << k;
    expect_cells(dataset, 3);
  };
  EXPECT_GE(fail_each_call([&](int) { return writer->close(); }, undone), 6);
  EXPECT_EQ(contents_of(dataset), reference);
}

TEST_F(DatasetFault, ADiskThatStaysBrokenLosesNoDurableCell) {
  for (int k = 0;; ++k) {
    const fs::path dataset = folder_ / ("lamp" + std::to_string(k) + ".lumi");
    scan(dataset, 1);
    Result<DatasetWriter> writer = DatasetWriter::resume(dataset, geometry_);
    ASSERT_TRUE(writer);
    int calls = 0;
    before_call = [&](const char*) { return calls++ >= k ? EIO : 0; };
    const Status second = add(*writer, 1);
    const Status closed = second ? writer->close() : second;
    before_call = nullptr;
    expect_cells(dataset, second ? 2 : 1);
    writer = fail("", "");
    finish(dataset);
    expect_cells(dataset, 3);
    EXPECT_EQ(temporaries(), 0);
    if (closed) break;
    ASSERT_LT(k, 100);
  }
}

TEST_F(DatasetFault, DyingAtAnyCallLosesNoDurableCell) {
  const std::string reference = uninterrupted();
  const fs::path dataset = folder_ / "lamp.lumi";
  int durable = 0, snapshots = 0;
  std::vector<int> durable_at;
  before_call = [&](const char*) {
    fs::copy(folder_, folder_.string() + "." + std::to_string(snapshots++), fs::copy_options::recursive);
    durable_at.push_back(durable);
    return 0;
  };
  short_writes = true;
  {
    Result<DatasetWriter> writer = create(dataset);
    ASSERT_TRUE(writer);
    for (; durable < 3; ++durable) {
      ASSERT_TRUE(writer->record_provenance("{}"));
      ASSERT_TRUE(add(*writer, durable));
    }
    ASSERT_TRUE(writer->close());
  }
  stop();
  EXPECT_EQ(contents_of(dataset), reference);
  for (int k = 0; k < snapshots; ++k) {
    const fs::path copy = folder_.string() + "." + std::to_string(k);
    if (fs::exists(copy / "lamp.lumi")) {
      expect_cells(copy / "lamp.lumi", durable_at[static_cast<std::size_t>(k)]);
    } else {
      EXPECT_EQ(durable_at[static_cast<std::size_t>(k)], 0);
      scan(copy / "lamp.lumi", 0);
    }
    finish(copy / "lamp.lumi");
    EXPECT_EQ(contents_of(copy / "lamp.lumi"), reference) << "died at call " << k;
    EXPECT_FALSE(fs::exists(copy / "lamp.lumi.unfinished"));
    fs::remove_all(copy);
  }
  EXPECT_GE(snapshots, 60);
}

TEST_F(DatasetFault, DyingWhileClosingKeepsTheLastGeneration) {
  const fs::path dataset = folder_ / "lamp.lumi";
  scan(dataset, 1);
  Result<DatasetWriter> writer = DatasetWriter::resume(dataset, geometry_);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->add({0, 0}, cell_image(geometry_, 7), {0, 0}));
  int snapshots = 0;
  before_call = [&](const char*) {
    const Result<Dataset> read = read_dataset(dataset);
    EXPECT_TRUE(read) << read.error().message();
    ++snapshots;
    if (!read) return 0;
    EXPECT_EQ(read->light_field.cell({0, 0})->value, cell_image(geometry_, 7).value);
    EXPECT_THAT(read->index.notes, testing::IsEmpty());
    return 0;
  };
  ASSERT_TRUE(writer->close());
  stop();
  EXPECT_GE(snapshots, 8);
  EXPECT_EQ(std::distance(fs::directory_iterator(dataset / "cells"), fs::directory_iterator()), 1);
}

TEST_F(DatasetFault, IgnoresAndCutsAJournalTornAnywhereInItsLastLine) {
  const std::string reference = uninterrupted();
  const fs::path whole = folder_ / "whole.lumi", dataset = folder_ / "lamp.lumi";
  scan(whole, 2);
  const std::string journal = read_text(whole / "journal.jsonl");
  const std::size_t begin = journal.find('\n') + 1;
  for (std::size_t length = begin; length <= journal.size(); ++length) {
    fs::remove_all(dataset);
    fs::copy(whole, dataset, fs::copy_options::recursive);
    write_text(dataset / "journal.jsonl", journal.substr(0, length));
    // A line that lacks its newline only is whole.
    const int cells = length + 1 >= journal.size() ? 2 : 1;
    const bool torn = length > begin && cells == 1;
    const Result<Dataset> read = read_dataset(dataset);
    ASSERT_TRUE(read) << length << read.error().message();
    EXPECT_EQ(read->light_field.coverage().measured, cells) << length;
    EXPECT_EQ(read->index.notes.size(), torn ? 1u : 0u) << length;
    finish(dataset);
    EXPECT_EQ(contents_of(dataset), reference) << length;
  }
  // A line that is damaged but ended.
  write_text(whole / "journal.jsonl", journal + "{\"row\": 0, \"col\n");
  EXPECT_THAT(read_dataset(whole)->index.notes, testing::ElementsAre(HasSubstr("journal.jsonl: line 3")));
  write_text(whole / "journal.jsonl", std::string(20, '\0') + "\n" + journal);
  EXPECT_THAT(read_dataset(whole)->index.notes, testing::ElementsAre(HasSubstr("a damaged line is ignored")));
  EXPECT_EQ(read_dataset(whole)->light_field.coverage().measured, 2);
}

TEST_F(DatasetFault, AFullDiskIsAnErrorAndTheScanGoesOnOnceThereIsRoom) {
  const fs::path disk = folder_ / "disk";
  fs::create_directories(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=256k") != 0)
    GTEST_SKIP() << "mounting a small disk is not permitted here: " << std::strerror(errno);
  geometry_ = support::geometry(3, 1, 100, 100, {"Y"});
  write_text(disk / "ballast", std::string(100'000, 'x'));
  {
    Result<DatasetWriter> writer = create(disk / "lamp.lumi");
    ASSERT_TRUE(writer) << writer.error().message();
    EXPECT_TRUE(add(*writer, 0));
    const Status full = add(*writer, 1);
    ASSERT_FALSE(full);
    EXPECT_THAT(full.error().message(), HasSubstr("No space left on device; free space on that disk"));
    expect_cells(disk / "lamp.lumi", 1);
    EXPECT_EQ(temporaries(), 0);
    fs::remove(disk / "ballast");
    EXPECT_TRUE(add(*writer, 1));
    expect_cells(disk / "lamp.lumi", 2);
  }
  EXPECT_EQ(::umount(disk.c_str()), 0);
}

TEST_F(DatasetFault, AFullDeviceIsAnError) {
  const Status full = append_durably("/dev/full", "one line\n", 0);
  ASSERT_FALSE(full);
  EXPECT_THAT(full.error().message(), HasSubstr("/dev/full: could not be appended to: No space left on device"));
}

}  // namespace
}  // namespace lumifield
