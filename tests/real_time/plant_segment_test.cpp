// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/real_time/plant_segment.hpp>

#include <atomic>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tactus::real_time {
namespace plant_segment_test {

/// A name of this process alone.
std::string name_of(const char* test) { return std::string("test-") + test + "-" + std::to_string(getpid()); }
std::string file_of(const std::string& name) { return "/tactus-plant-" + name; }

PlantFacts some_facts() {
  return {.master = {.force_N = 1.5, .handle_force_N = 0.5},
          .slave = {.force_N = 3.0},
          .taps = 4,
          .configuration = "[servo]\nrate_Hz = 5000.0\n"};
}

/// A process that stays in the segment until it is killed.
class Inhabitant {
 public:
  template <class Enter>
  explicit Inhabitant(Enter enter) {
    int ends[2];
    if (pipe(ends) != 0) return;
    child_ = fork();
    if (child_ == 0) {
      alarm(60);
      const auto segment = enter();
      const char in = segment ? 'y' : 'n';
      (void)!write(ends[1], &in, 1);
      for (;;) pause();
    }
    (void)!read(ends[0], &in_, 1);
    close(ends[0]);
    close(ends[1]);
  }
  Inhabitant(const Inhabitant&) = delete;
  Inhabitant& operator=(const Inhabitant&) = delete;
  ~Inhabitant() { end(); }
  void end() {
    if (child_ <= 0) return;
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
    child_ = -1;
  }
  [[nodiscard]] bool is_in() const { return in_ == 'y'; }
  [[nodiscard]] pid_t process() const { return child_; }

 private:
  pid_t child_ = -1;
  char in_ = 'n';
};

void expect_error(const Result<PlantSegment>& refused, ErrorCode code, const std::string& word) {
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, code);
  EXPECT_NE(describe(refused.error()).find(word), std::string::npos) << describe(refused.error());
}

TEST(PlantSegment, TellsItsControllerWhatItIsAndGoesWithItsOwner) {
  const std::string name = name_of("facts");
  {
    const auto owner = PlantSegment::create(name, some_facts());
    ASSERT_TRUE(owner) << describe(owner.error());
    EXPECT_FALSE(owner->living_controller());
    {
      auto controller = PlantSegment::attach(name);
      ASSERT_TRUE(controller) << describe(controller.error());
      const PlantFacts told = controller->facts();
      EXPECT_EQ(told.master.force_N, 1.5);
      EXPECT_EQ(told.master.handle_force_N, 0.5);
      EXPECT_EQ(told.slave.force_N, 3.0);
      EXPECT_EQ(told.taps, 4);
      EXPECT_EQ(told.configuration, some_facts().configuration);
      EXPECT_EQ(controller->living_owner(), getpid());
      EXPECT_EQ(owner->living_controller(), getpid());

      EXPECT_FALSE(owner->request().tap);
      const std::uint64_t first = controller->ask(3);
      EXPECT_EQ(owner->request().session, first);
      EXPECT_EQ(owner->request().tap, 3U);
      EXPECT_NE(controller->ask(std::nullopt), first);
      EXPECT_FALSE(owner->request().tap);
    }
    EXPECT_FALSE(owner->living_controller());
    EXPECT_TRUE(PlantSegment::attach(name)) << "another one may come";
  }
  expect_error(PlantSegment::attach(name), ErrorCode::missing, "tactus plant EXPERIMENT --name " + name);
}

TEST(PlantSegment, HasOneOwnerAndOneController) {
  const std::string name = name_of("one");
  const Inhabitant owner([&] { return PlantSegment::create(name, some_facts()); });
  ASSERT_TRUE(owner.is_in());
  expect_error(PlantSegment::create(name, some_facts()), ErrorCode::inconsistent,
               "process " + std::to_string(owner.process()));
  Inhabitant controller([&] { return PlantSegment::attach(name); });
  ASSERT_TRUE(controller.is_in());
  expect_error(PlantSegment::attach(name), ErrorCode::inconsistent, "process " + std::to_string(controller.process()));
  controller.end();
  EXPECT_TRUE(PlantSegment::attach(name)) << "a controller that was killed holds no place";
  shm_unlink(file_of(name).c_str());
}

TEST(PlantSegment, WhatAKilledOwnerLeftIsKnownAndReplaced) {
  const std::string name = name_of("stale");
  Inhabitant dead([&] { return PlantSegment::create(name, some_facts()); });
  ASSERT_TRUE(dead.is_in());
  const std::string process = "process " + std::to_string(dead.process());
  const auto witness = PlantSegment::attach(name);
  ASSERT_TRUE(witness);
  EXPECT_EQ(witness->living_owner(), dead.process());
  dead.end();
  EXPECT_FALSE(witness->living_owner());
  expect_error(PlantSegment::attach(name), ErrorCode::missing, process);
  PlantFacts other = some_facts();
  other.taps = 9;
  const auto owner = PlantSegment::create(name, other);
  ASSERT_TRUE(owner) << describe(owner.error());
  const auto controller = PlantSegment::attach(name);
  ASSERT_TRUE(controller) << "the controller of the old one is not in the new one";
  EXPECT_EQ(controller->facts().taps, 9);
  EXPECT_EQ(witness->facts().taps, 4) << "the old one is not touched";
}

TEST(PlantSegment, OfSeveralThatReplaceItAtOnceOneWins) {
  const std::string name = name_of("race");
  for (int round = 0; round < 5; ++round) {
    Inhabitant dead([&] { return PlantSegment::create(name, some_facts()); });
    ASSERT_TRUE(dead.is_in());
    dead.end();
    std::atomic<int> winners{0};
    std::atomic<int> done{0};
    std::vector<std::thread> all;
    for (int i = 0; i < 4; ++i) {
      all.emplace_back([&] {
        const auto mine = PlantSegment::create(name, some_facts());
        winners += mine ? 1 : 0;
        ++done;
        while (done < 4) std::this_thread::yield();
      });
    }
    for (std::thread& thread : all) thread.join();
    EXPECT_EQ(winners, 1);
  }
}

TEST(PlantSegment, MemoryOfAnotherKindIsRefused) {
  const std::string name = name_of("other");
  const std::string file = file_of(name);
  for (const bool right_size : {false, true}) {
    const int descriptor = shm_open(file.c_str(), O_RDWR | O_CREAT | O_EXCL, 0600);
    ASSERT_GE(descriptor, 0);
    ASSERT_EQ(ftruncate(descriptor, right_size ? static_cast<off_t>(sizeof(PlantLayout)) : 100), 0);
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_len = 1;
    ASSERT_EQ(fcntl(descriptor, F_OFD_SETLK, &lock), 0);
    expect_error(PlantSegment::attach(name), ErrorCode::inconsistent, "version");
    expect_error(PlantSegment::create(name, some_facts()), ErrorCode::inconsistent, "another name");
    close(descriptor);
    EXPECT_TRUE(PlantSegment::create(name, some_facts())) << "nobody owns it any more";
  }
}

TEST(PlantSegment, AFileThatOthersCanChangeIsRefusedBeforeItIsBelieved) {
  const std::string name = name_of("foreign");
  const auto owner = PlantSegment::create(name, some_facts());
  ASSERT_TRUE(owner);
  const std::string path = "/dev/shm" + file_of(name);
  for (const mode_t open : {0660U, 0606U, 0640U}) {
    ASSERT_EQ(chmod(path.c_str(), open), 0);
    expect_error(PlantSegment::attach(name), ErrorCode::inconsistent, "open to other users");
    expect_error(PlantSegment::create(name, some_facts()), ErrorCode::inconsistent, path);
  }
  ASSERT_EQ(chmod(path.c_str(), 0600), 0);
  EXPECT_TRUE(PlantSegment::attach(name));

  const std::string alias = name_of("alias");
  ASSERT_EQ(symlink(path.c_str(), ("/dev/shm" + file_of(alias)).c_str()), 0);
  EXPECT_FALSE(PlantSegment::attach(alias)) << "a link is not followed";
  shm_unlink(file_of(alias).c_str());

  if (geteuid() != 0) GTEST_SKIP() << "only root can give a file to another user";
  ASSERT_EQ(chown(path.c_str(), 65534, 65534), 0);
  expect_error(PlantSegment::attach(name), ErrorCode::inconsistent, "belongs to user 65534");
  expect_error(PlantSegment::create(name, some_facts()), ErrorCode::inconsistent, "as user 0");
}

TEST(PlantSegment, CutShortByAnotherProcessItReadsAsZerosOnBothSides) {
  const std::string name = name_of("cut");
  const auto owner = PlantSegment::create(name, some_facts());
  ASSERT_TRUE(owner);
  auto controller = PlantSegment::attach(name);
  ASSERT_TRUE(controller);
  EXPECT_EQ(controller->facts().taps, 4);
  const pid_t child = fork();
  if (child == 0) _exit(truncate(("/dev/shm" + file_of(name)).c_str(), 0) == 0 ? 0 : 1);
  int status = -1;
  waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);
  for (const PlantSegment* side : {&*owner, static_cast<const PlantSegment*>(&*controller)}) {
    EXPECT_FALSE(side->is_cut()) << "nobody has looked yet";
    EXPECT_EQ(side->facts().taps, 0);
    EXPECT_TRUE(side->is_cut());
    EXPECT_FALSE(side->request().tap);
  }
  EXPECT_NE(controller->ask(3), 0U) << "writing is survived too";
  EXPECT_FALSE(owner->request().tap) << "and reaches nobody";
  expect_error(PlantSegment::attach(name), ErrorCode::inconsistent, "version");
}

TEST(PlantSegment, AFaultOfItsOwnStillEndsAProgram) {
  const std::string name = name_of("faulty");
  const auto owner = PlantSegment::create(name, some_facts());
  ASSERT_TRUE(owner);
  const pid_t child = fork();
  if (child == 0) {
    const int file = open("/dev/shm", O_RDWR | O_TMPFILE, 0600);
    void* page = mmap(nullptr, 4096, PROT_READ, MAP_SHARED, file, 0);
    _exit(*static_cast<volatile char*>(page) == 0 ? 42 : 43);
  }
  int status = 0;
  waitpid(child, &status, 0);
  // A sanitizer ends it by a status of its own.
  const bool read = WIFEXITED(status) && (WEXITSTATUS(status) == 42 || WEXITSTATUS(status) == 43);
  EXPECT_FALSE(read) << "a page that no file has was read";
}

TEST(PlantSegment, ANameIsLettersDigitsAndDashes) {
  for (const std::string& bad : {std::string(), std::string("a/b"), std::string("a b"), std::string(65, 'a')}) {
    expect_error(PlantSegment::create(bad, some_facts()), ErrorCode::syntax, "bench-1");
    expect_error(PlantSegment::attach(bad), ErrorCode::syntax, "bench-1");
  }
  PlantFacts large = some_facts();
  large.configuration.assign(PlantLayout::configuration_bytes + 1, ' ');
  expect_error(PlantSegment::create(name_of("large"), large), ErrorCode::inconsistent, "32769");
}

}  // namespace plant_segment_test
}  // namespace tactus::real_time
