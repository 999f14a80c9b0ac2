// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/line_writer.hpp>
#include <tactus/interfaces/cli/operator_input.hpp>

#include <array>
#include <chrono>
#include <csignal>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace tactus::cli {
namespace person_test {

using namespace std::chrono_literals;
using control::SiteRole;
using runtime::SiteExchange;
using runtime::SiteWord;
using std::chrono::steady_clock;

/// A pipe whose ends are closed with it.
struct Pipe {
  Pipe() { EXPECT_EQ(pipe(ends.data()), 0); }
  ~Pipe() {
    close_input();
    close(ends[0]);
  }
  void write(const std::string& text) const {
    EXPECT_EQ(::write(ends[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void close_input() {
    if (ends[1] >= 0) close(ends[1]);
    ends[1] = -1;
  }
  /// Full to the last byte.
  void fill() const {
    fcntl(ends[1], F_SETFL, O_NONBLOCK);
    const std::string some(4096, '.');
    while (::write(ends[1], some.data(), some.size()) > 0) {
    }
    fcntl(ends[1], F_SETFL, 0);
  }
  /// All that is there, up to the end where the writer is gone.
  [[nodiscard]] std::string read_to_end() {
    close_input();
    std::string all;
    std::array<char, 4096> part{};
    for (ssize_t size = 1; size > 0;) {
      size = read(ends[0], part.data(), part.size());
      if (size > 0) all.append(part.data(), static_cast<std::size_t>(size));
    }
    return all;
  }
  std::array<int, 2> ends{-1, -1};
};

bool eventually(const std::function<bool()>& holds) {
  for (const auto last = steady_clock::now() + 20s; steady_clock::now() < last; std::this_thread::sleep_for(1ms)) {
    if (holds()) return true;
  }
  return false;
}

class OperatorAtASite : public ::testing::Test {
 protected:
  void begin(SiteRole role = SiteRole::master) {
    auto made = OperatorInput::listen_to(typed.ends[0], role, exchange, lines);
    ASSERT_TRUE(made);
    person = *std::move(made);
  }
  /// The next word that comes, patiently.
  SiteWord next() {
    runtime::SiteCommand command;
    EXPECT_TRUE(eventually([&] { return exchange.words.try_pop(command); }));
    return command.word;
  }

  Pipe typed, terminal;
  SiteExchange exchange;
  LineWriter lines{terminal.ends[1]};
  std::unique_ptr<OperatorInput> person;
};

TEST_F(OperatorAtASite, IsHeardInOrderWhileNobodyReadsTheTerminal) {
  terminal.fill();
  begin();
  typed.write("arm\nnonsense\nrelease\n");
  EXPECT_EQ(next(), SiteWord::arm);
  EXPECT_EQ(next(), SiteWord::release);
  kill(getpid(), SIGUSR1);
  EXPECT_EQ(next(), SiteWord::arm);
  EXPECT_FALSE(exchange.person_lost);
}

TEST_F(OperatorAtASite, MayTypeAheadOfTheSite) {
  begin();
  std::string many;
  for (int i = 0; i < 50; ++i) many += "press\nrelease\n";
  typed.write(many);
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(next(), SiteWord::press);
    EXPECT_EQ(next(), SiteWord::release);
  }
}

TEST_F(OperatorAtASite, IsGoneWhereTheInputEndsAfterTheLastWord) {
  begin();
  typed.write("clutch\nunclutch");
  typed.close_input();
  EXPECT_EQ(next(), SiteWord::clutch);
  EXPECT_EQ(next(), SiteWord::unclutch);
  EXPECT_TRUE(eventually([&] { return exchange.person_lost.load(); }));
  person.reset();
  EXPECT_FALSE(lines.finish(""));
  EXPECT_NE(terminal.read_to_end().find("standard input has ended: that is `release`"), std::string::npos);
}

TEST_F(OperatorAtASite, IsGoneWhereTheInputFails) {
  close(typed.ends[0]);
  typed.ends[0] = open("/dev/null", O_WRONLY);
  begin();
  EXPECT_TRUE(eventually([&] { return exchange.person_lost.load(); }));
}

TEST(LineWriter, WritesInOrderAndTheLastTextToItsEnd) {
  Pipe pipe;
  LineWriter writer(pipe.ends[1]);
  const std::string last(1'000'000, 'x');
  std::string read;
  std::thread reader([&] {
    std::array<char, 3000> part{};
    while (read.size() < last.size() + 8) {
      const ssize_t size = ::read(pipe.ends[0], part.data(), part.size());
      read.append(part.data(), static_cast<std::size_t>(size));
    }
  });
  writer.say("one\n");
  writer.say("two\n");
  EXPECT_FALSE(writer.finish(last));
  reader.join();
  EXPECT_EQ(read, "one\ntwo\n" + last);
  EXPECT_EQ(writer.dropped(), 0U);
}

TEST(LineWriter, NeverWaitsForAReaderAndCountsWhatItDrops) {
  Pipe pipe;
  pipe.fill();
  LineWriter writer(pipe.ends[1]);
  // One is on its way, and the rest waits.
  const std::size_t lines = LineWriter::most_waiting + 101;
  for (std::size_t i = 0; i < lines; ++i) writer.say("line\n");
  EXPECT_GE(writer.dropped(), 100U);
  EXPECT_LE(writer.dropped(), 101U);
  const auto error = writer.finish("last\n");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::unwritable);
  EXPECT_NE(describe(*error).find("nobody reads"), std::string::npos) << describe(*error);
  // Its thread still waits: let it end before the pipe is closed.
  close(pipe.ends[0]);
  pipe.ends[0] = -1;
}

TEST(LineWriter, SaysThatItCouldNotWrite) {
  const int full = open("/dev/full", O_WRONLY);
  LineWriter writer(full);
  writer.say("line\n");
  EXPECT_TRUE(writer.finish("last\n"));
  close(full);
}

}  // namespace person_test
}  // namespace tactus::cli
