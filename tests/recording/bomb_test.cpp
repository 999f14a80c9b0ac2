// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <string>

#include "tests/recording/files.hpp"
#include "tests/sanitizers.hpp"
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

/// Small files that claim, or are, far more than they seem.
namespace tactus::recording {
namespace {

std::string bytes_of_words(std::initializer_list<std::uint32_t> words) {
  std::string bytes;
  for (const std::uint32_t word : words) {
    char buffer[sizeof word];
    std::memcpy(buffer, &word, sizeof word);
    bytes.append(buffer, sizeof word);
  }
  return bytes;
}

/// A zlib stream of `start` and then as many zeros as MiB are asked for, each of them packed into a kilobyte. Its check
/// sum is wrong, which whoever unpacks it learns at its end.
std::string packed_zeros(const std::string& start, std::size_t MiB) {
  const std::string zeros(std::size_t{1} << 20U, '\0');
  z_stream stream{};
  deflateInit(&stream, 9);
  const auto pack = [&stream](const std::string& plain) {
    std::string packed(plain.size() + 1000, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));
    stream.avail_in = static_cast<uInt>(plain.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, Z_FULL_FLUSH);
    packed.resize(packed.size() - stream.avail_out);
    return packed;
  };
  std::string result = pack(start);
  const std::string one = pack(zeros);
  for (std::size_t i = 0; i < MiB; ++i) result += one;
  deflateEnd(&stream);
  return result;
}

class Bomb : public RecordingFiles {
 protected:
  std::string header() const {
    return bytes_of(write_mat(path("header.mat"), {matrix("x", 2, 1, {1, 2})}, MAT_COMPRESSION_NONE)).substr(0, 128);
  }
  static std::string compressed(const std::string& packed) {
    return bytes_of_words({15, static_cast<std::uint32_t>(packed.size())}) + packed;
  }
  static std::string deflated(const std::string& plain) {
    uLongf length = compressBound(static_cast<uLong>(plain.size()));
    std::string packed(length, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &length, reinterpret_cast<const Bytef*>(plain.data()),
             static_cast<uLong>(plain.size()));
    packed.resize(length);
    return packed;
  }

  /// That the file is refused with these words, within 1 GB and 20 s of processor time. It is read in a process of its
  /// own that gets no more than 2 GB.
  static void expect_refusal(const std::filesystem::path& file, const char* words) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
#if !TACTUS_UNDER_ADDRESS_SANITIZER && !TACTUS_UNDER_THREAD_SANITIZER
      const rlimit limit{.rlim_cur = rlim_t{2} << 30U, .rlim_max = rlim_t{2} << 30U};
      setrlimit(RLIMIT_AS, &limit);
#endif
      const std::string told = refusal({.file = file, .variable = "x"});
      _exit(::write(ends[1], told.data(), told.size()) == static_cast<ssize_t>(told.size()) ? 0 : 1);
    }
    close(ends[1]);
    std::string told(2000, '\0');
    told.resize(static_cast<std::size_t>(std::max<ssize_t>(0, ::read(ends[0], told.data(), told.size()))));
    close(ends[0]);
    int status = 0;
    rusage used{};
    ASSERT_EQ(wait4(child, &status, 0, &used), child);
    EXPECT_EQ(status, 0);
    EXPECT_TRUE(says(told, words)) << told;
    EXPECT_TRUE(says(told, file.filename().string())) << told;
#if !TACTUS_UNDER_ADDRESS_SANITIZER && !TACTUS_UNDER_THREAD_SANITIZER
    EXPECT_LT(used.ru_maxrss, 1'000'000) << "kB of " << file;
#endif
    EXPECT_LT(used.ru_utime.tv_sec + used.ru_stime.tv_sec, 20);
  }
};

TEST_F(Bomb, ThreeMegabytesThatUnpackToThreeGigabytesAreRefusedByWhatTheyClaim) {
  constexpr std::size_t MiB = 3000;
  const std::string start = bytes_of_words({14, MiB << 20U});
  const auto file = write("zeros.mat", header() + compressed(packed_zeros(start, MiB)));
  ASSERT_LT(std::filesystem::file_size(file), 4'000'000U);
  expect_refusal(file, "may take 256 MiB; save only the variables that are needed");
  expect_refusal(file, "claim 3145728008 unpacked");
}

TEST_F(Bomb, ThoseThatClaimLessAreStoppedWhereTheClaimEnds) {
  const auto file = write("liar.mat", header() + compressed(packed_zeros(bytes_of_words({14, 1000}), 3000)));
  expect_refusal(file, "its compressed data are damaged");
}

TEST_F(Bomb, ManyVariablesThatAreEachWithinTheBoundAreCountedTogether) {
  const std::string plain = bytes_of(
      write_mat(path("plain.mat"), {matrix("x", 4'000'000, 1, std::vector<double>(4'000'000))}, MAT_COMPRESSION_ZLIB));
  std::string many = plain;
  for (int i = 0; i < 20; ++i) many += plain.substr(128);  // 32 MB each
  expect_refusal(write("many.mat", many), "at variable 9");
}

TEST_F(Bomb, AMillionEmptyMembersInAKilobyteAreRefused) {
  std::string matrix = bytes_of_words({6, 8, 2, 0, 5, 8, 1, 1'000'000, 1, 1}) + std::string("x\0\0\0\0\0\0\0", 8) +
                       bytes_of_words({5U | 4U << 16U, 8, 1, 8}) + std::string("a\0\0\0\0\0\0\0", 8);
  for (int i = 0; i < 1'000'000; ++i) matrix.append("\x0e\0\0\0\0\0\0\0", 8);
  const std::string element = bytes_of_words({14, static_cast<std::uint32_t>(matrix.size())}) + matrix;
  const auto file = write("members.mat", header() + compressed(deflated(element)));
  ASSERT_LT(std::filesystem::file_size(file), 30'000U);
  expect_refusal(file, "more than the 100000 arrays");
}

TEST_F(Bomb, ATableOfCommasAHugeOneAndAHugeHoleAreRefused) {
  const std::string commas(20'000'000, ',');
  expect_refusal(write("head.csv", std::string("x").append(commas).append("\n1,2\n1,2\n")),
                 "has 20000001 columns, more than the 4096");
  expect_refusal(write("line.csv", std::string("x,y\n1,2\n").append(commas).append("\n1,2\n")),
                 "has 20000001 fields where the header has 2");
  for (const char* name : {"hole.csv", "hole.mat"}) {
    const auto file = write(name, "x\n");
    std::filesystem::resize_file(file, std::uintmax_t{1} << 36U);
    expect_refusal(file, "bytes, more than the");
  }
}

TEST_F(Bomb, MoreSamplesThanOneColumnMayHaveAreRefusedInBothFormats) {
  constexpr std::size_t count = (std::size_t{1} << 24U) + 1;
  std::string table("x\n");
  for (std::size_t i = 0; i < count; ++i) table.append("1\n");
  expect_refusal(write("long.csv", table), "more than the 16777216 samples");
  const auto file = write_mat(
      path("long.mat"), {matrix<std::int8_t>("x", MAT_C_INT8, MAT_T_INT8, count, 1, std::vector<std::int8_t>(count))},
      MAT_COMPRESSION_NONE);
  expect_refusal(file, "more than the 16777216 that are read");
}

/// The time that a reader takes over input of twice the size, as a multiple.
template <class Read>
double growth(Read&& seconds_of, int size) {
  const double once = seconds_of(size);
  return seconds_of(2 * size) / (once + 0.05);  // what takes no time at all says nothing about its growth
}

TEST_F(Bomb, EveryReaderTakesTimeInProportionToItsInput) {
  const auto reading = [](const std::filesystem::path& file) {
    const std::clock_t start = std::clock();
    EXPECT_TRUE(contents(file));
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  EXPECT_LT(growth(
                [&](int rows) {
                  std::string table("x,y\n");
                  for (int i = 0; i < rows; ++i) table += "1,2\n";
                  return reading(write("long.csv", table));
                },
                200'000),
            3.0);
  EXPECT_LT(growth(
                [&](int fields) {
                  std::size_t one[] = {1, 1};
                  std::vector<std::string> names;
                  for (int i = 0; i < fields; ++i) names.push_back(std::string(1, 'f').append(std::to_string(i)));
                  std::vector<const char*> pointers;
                  for (const std::string& name : names) pointers.push_back(name.c_str());
                  matvar_t* all = Mat_VarCreateStruct("s", 2, one, pointers.data(), static_cast<unsigned>(fields));
                  return reading(write_mat(path("wide.mat"), {all}, MAT_COMPRESSION_ZLIB));
                },
                20'000),
            3.0);
}

}  // namespace
}  // namespace tactus::recording
