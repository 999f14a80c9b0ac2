// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>

#include "tests/recording/files.hpp"
#include <zlib.h>

/// Files that are cut or changed. TACTUS_FUZZ_ROUNDS in the environment asks for more of them.
///
/// A changed file may still be a sound file with other numbers in it; what may not
/// happen is a crash, a value that is not finite or a word on standard error. Run under sanitizers, these tests say
/// more.
namespace tactus::recording {
namespace {

class DamagedMat : public RecordingFiles {
 protected:
  /// A file with everything in it that matio would parse.
  std::string sound(matio_compression compression) {
    std::size_t two[] = {2, 1};
    double numbers[] = {1, 2};
    mat_uint32_t rows[] = {0, 1};
    mat_uint32_t columns[] = {0, 2};
    mat_sparse_t sparse{2, rows, 2, columns, 2, 2, numbers};
    matvar_t* cells[] = {matrix("", 2, 1, {1, 2}), scope("", 3)};
    const char* fields[] = {"sparse", "cells"};
    std::size_t one[] = {1, 1};
    matvar_t* inside = Mat_VarCreateStruct("inside", 2, one, fields, 2);
    Mat_VarSetStructFieldByName(
        inside, "sparse", 0,
        Mat_VarCreate("sparse", MAT_C_SPARSE, MAT_T_DOUBLE, 2, two, &sparse, MAT_F_DONT_COPY_DATA));
    Mat_VarSetStructFieldByName(inside, "cells", 0, Mat_VarCreate("cells", MAT_C_CELL, MAT_T_CELL, 2, two, cells, 0));
    const auto file = write_mat(
        path("sound.mat"),
        {inside, scope("scope", 6), matrix<std::int16_t>("i", MAT_C_INT16, MAT_T_INT16, 3, 1, {1, 2, 3})}, compression);
    return bytes_of(file);
  }

  /// Reads from a file of these bytes; true if a signal came out of it.
  bool survives(const std::string& bytes) {
    const auto file = write("damaged.mat", bytes);
    bool any = false;
    for (const Source& source : {Source{.file = file, .variable = "scope.signals(2).values", .column = 2},
                                 Source{.file = file, .variable = "i"}}) {
      const Result<Signal> signal = read(source);
      if (!signal) continue;
      any = true;
      EXPECT_GE(signal->values.size(), 2U);
      for (const double value : signal->values) EXPECT_TRUE(std::isfinite(value));
    }
    return any;
  }

  static std::uint32_t word(const std::string& bytes, std::size_t offset) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
  }

  /// The same file, each variable compressed: with the check sums right, damage reaches what is inside.
  static std::string compressed(const std::string& plain) {
    std::string packed = plain.substr(0, 128);
    for (std::size_t offset = 128; offset + 8 <= plain.size();) {
      const std::size_t size = std::min<std::size_t>(8 + word(plain, offset + 4), plain.size() - offset);
      uLongf length = compressBound(static_cast<uLong>(size));
      std::string content(length, '\0');
      compress(reinterpret_cast<Bytef*>(content.data()), &length, reinterpret_cast<const Bytef*>(plain.data() + offset),
               static_cast<uLong>(size));
      content.resize(length);
      const std::uint32_t tag[] = {15, static_cast<std::uint32_t>(length)};
      packed.append(reinterpret_cast<const char*>(tag), sizeof tag);
      packed += content;
      offset += size;
    }
    return packed;
  }
};

TEST_F(DamagedMat, AFileCutAnywhereIsRefusedOrHoldsWhatItHeldBefore) {
  ::testing::internal::CaptureStderr();
  for (const matio_compression compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    const std::string whole = sound(compression);
    ASSERT_TRUE(survives(whole));
    std::size_t read_after_cut = 0;
    for (std::size_t size = 0; size < whole.size(); size += 3)
      read_after_cut += survives(whole.substr(0, size)) ? 1U : 0U;
    // Only a cut between two variables leaves a sound file, and at most one of those cuts keeps the scope.
    EXPECT_LE(read_after_cut, 1U);
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST_F(DamagedMat, ACutFileSaysThatItIsDamagedAndWhere) {
  const std::string whole = sound(MAT_COMPRESSION_NONE);
  const auto file = write("cut.mat", whole.substr(0, whole.size() - 9));
  const auto error = read({.file = file, .variable = "scope.time"}).error();
  EXPECT_EQ(error.place, file.string());
  EXPECT_TRUE(says(error.message, "is damaged in variable 3")) << error.message;
}

TEST_F(DamagedMat, AFlippedBitInACompressedVariableIsAlwaysNoticed) {
  const std::string whole = sound(MAT_COMPRESSION_ZLIB);
  const std::size_t second = 128 + 8 + word(whole, 132);
  const std::size_t content = second + 8;
  for (std::size_t i = content; i < content + word(whole, second + 4); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    ASSERT_FALSE(survives(damaged)) << i;
  }
}

TEST_F(DamagedMat, NoFlippedBitAndNoForgedSizeCrashes) {
  ::testing::internal::CaptureStderr();
  const std::string whole = sound(MAT_COMPRESSION_NONE);
  std::mt19937 random(20240917);
  std::uniform_int_distribution<std::size_t> anywhere(128, whole.size() - 4);
  std::uniform_int_distribution<std::uint32_t> any_word;
  const std::uint32_t forged[] = {0U,          1U,          7U,          0x7fffffffU, 0x80000000U,
                                  0xffffffffU, 0xfffffff8U, 0x00010005U, 14U,         15U};
  const int rounds = [] {
    const char* n = std::getenv("TACTUS_FUZZ_ROUNDS");
    return n != nullptr ? std::atoi(n) : 600;
  }();
  for (int round = 0; round < rounds; ++round) {
    std::string damaged = whole;
    const std::size_t place = anywhere(random);
    if (round % 3 == 0) {
      damaged[place] = static_cast<char>(damaged[place] ^ (1 << (any_word(random) % 8)));
    } else {
      const std::uint32_t value = round % 3 == 1 ? forged[any_word(random) % std::size(forged)] : any_word(random) % 64;
      std::memcpy(damaged.data() + place / 4 * 4, &value, sizeof value);
    }
    survives(damaged);
    survives(compressed(damaged));
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST_F(DamagedMat, ADimensionThatItsNumbersDoNotFillIsRefused) {
  std::string plain = bytes_of(write_mat(path("x.mat"), {matrix("x", 4, 1, {1, 2, 3, 4})}, MAT_COMPRESSION_NONE));
  // header 128, matrix tag 8, array flags 16, tag of the dimensions 8: the number of rows
  constexpr std::size_t rows_at = 128 + 8 + 16 + 8;
  ASSERT_EQ(word(plain, rows_at), 4U);
  for (const std::uint32_t rows : {3U, 5U, 1000000U, 0x40000000U, 0xffffffffU}) {
    std::memcpy(plain.data() + rows_at, &rows, sizeof rows);
    for (const std::string& bytes : {plain, compressed(plain)}) {
      EXPECT_TRUE(says(refusal({.file = write("forged.mat", bytes), .variable = "x"}), "is damaged in variable 1"))
          << rows;
    }
  }
}

TEST_F(DamagedMat, ARandomFileUnderASoundHeaderIsRefused) {
  std::mt19937 random(7);
  const std::string header = sound(MAT_COMPRESSION_NONE).substr(0, 128);
  for (int round = 0; round < 200; ++round) {
    std::string bytes = header;
    for (std::size_t i = 0; i < 8 + random() % 400; ++i) bytes += static_cast<char>(random());
    EXPECT_FALSE(survives(bytes));
  }
}

}  // namespace
}  // namespace tactus::recording
