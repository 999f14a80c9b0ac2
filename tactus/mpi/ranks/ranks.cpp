// SPDX-License-Identifier: Apache-2.0
#include <tactus/mpi/ranks/internal/ranks.hpp>
#include <tactus/simulation/tasks/bytes.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include <unistd.h>

namespace tactus::ranks {

namespace {

constexpr double alive_every_s = 0.5;
/// Ranks may take so long to read their files before they are ready.
constexpr double start_limit_s = 60.0;
constexpr double part_limit_s = 5.0;
constexpr std::chrono::milliseconds nap{1};
/// A rank has further tasks waiting if tasks take less than this; with longer ones, the last to finish would wait for
/// them at the end.
constexpr double short_task_s = 0.1;
/// The waiting tasks of a rank take this long, several times what a message needs.
constexpr double waiting_s = 0.005;
constexpr std::size_t most_waiting = 64;

double seconds(std::chrono::steady_clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

/// FNV-1a.
std::uint64_t hash_of(std::string_view text) {
  std::uint64_t hash = 14695981039346656037U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return hash;
}

std::string own_name(int rank) {
  char host[256] = {};
  if (gethostname(host, sizeof host - 1) != 0) host[0] = '\0';
  return "rank " + std::to_string(rank) + " (process " + std::to_string(getpid()) + " on " + host + ")";
}

std::string to_bytes(const Error& error) {
  return tasks::ByteWriter()
      .put(error.code)
      .put(std::string_view(error.parameter))
      .put(std::string_view(error.message))
      .put(std::string_view(error.place))
      .take();
}

Error error_of(std::string_view bytes) {
  tasks::ByteReader reader(bytes);
  Error error;
  reader.get(error.code);
  reader.get(error.parameter);
  reader.get(error.message);
  reader.get(error.place);
  return error;
}

Error failed(std::string message) {
  return {.code = ErrorCode::failed, .parameter = {}, .message = std::move(message), .place = {}};
}

}  // namespace

/// The tasks of one list, as the leading rank hands them out.
class Session::Ranks::Hand {
 public:
  explicit Hand(const tasks::TaskList& list) : list_(list) {}

  [[nodiscard]] bool all_done() const { return done_ == list_.count; }
  [[nodiscard]] double share() const { return static_cast<double>(done_) / static_cast<double>(list_.count); }
  void finished(double took_s) {
    ++done_;
    took_s_ += took_s;
  }
  /// Calls `give` with number and key until a rank with so many tasks has enough.
  template <class Give>
  void fill(std::size_t& in_flight, Give&& give) {
    while (in_flight < enough() && next_ < list_.count) {
      give(next_, list_.key(next_));
      ++next_;
      ++in_flight;
    }
  }

 private:
  /// How many tasks a rank should have, the one that it runs included.
  [[nodiscard]] std::size_t enough() const {
    if (done_ == 0) return 1;
    const double mean_s = took_s_ / static_cast<double>(done_);
    if (mean_s >= short_task_s) return 1;
    if (mean_s * static_cast<double>(most_waiting) <= waiting_s) return 1 + most_waiting;
    return 1 + static_cast<std::size_t>(std::ceil(waiting_s / mean_s));
  }

  const tasks::TaskList& list_;
  std::size_t next_ = 0, done_ = 0;
  double took_s_ = 0.0;
};

Session::Ranks::Ranks(MPI_Comm ranks) : mailbox_(ranks) {
  MPI_Comm_rank(ranks, &rank_);
  MPI_Comm_size(ranks, &size_);
  others_.resize(static_cast<std::size_t>(size_));
}

std::string Session::Ranks::name_of(int rank) const {
  const std::string& name = others_[static_cast<std::size_t>(rank)].name;
  return name.empty() ? "rank " + std::to_string(rank) : name;
}

/// Prints why and ends all ranks.
void Session::Ranks::give_up(int rank) const {
  const std::string why = "tactus: " + name_of(rank) + " does not respond: the job ends. The same command continues " +
                          "from the tasks that were finished, if it has --out\n";
  std::fputs(why.c_str(), stderr);
  std::fflush(stderr);
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::_Exit(1);
}

/// In the leading rank: sends a sign of life when it is due, and ends the job if a rank has been silent for too long.
void Session::Ranks::stay_in_touch() {
  const auto now = Clock::now();
  const double elapsed_s = seconds(now - std::exchange(now_, now));
  const bool due = seconds(now - last_sent_) >= alive_every_s;
  if (due) last_sent_ = now;
  for (int rank = 1; rank < size_; ++rank) {
    Rank& other = others_[static_cast<std::size_t>(rank)];
    if (other.gone) continue;
    if (due) mailbox_.send(rank, Kind::alive);
    other.silence.pass(elapsed_s);
    if (other.silence.lasted_s() > (other.ready ? silence_limit_s : start_limit_s)) give_up(rank);
  }
}

Check Session::Ranks::receive_ready(const Message& message, std::uint64_t job) {
  Rank& other = others_[static_cast<std::size_t>(message.rank)];
  tasks::ByteReader reader(message.bytes);
  const auto its_job = reader.get<std::uint64_t>();
  reader.get(other.name);
  if (its_job != job) {
    return failed(other.name +
                  " has another job than rank 0: start all ranks with the same program, options and files");
  }
  other.ready = true;
  return {};
}

Check Session::Ranks::run(const tasks::Job& job, const tasks::TaskList& list, const tasks::Take& take,
                          const tasks::Progress& progress) {
  ComputingThread own(job);
  Check error = hand_out(hash_of(job.description), own, list, take, progress);
  // The other ranks need not wait for the task that this one still runs.
  if (error) finish();
  return error;
}

Check Session::Ranks::hand_out(std::uint64_t job, ComputingThread& own, const tasks::TaskList& list,
                               const tasks::Take& take, const tasks::Progress& progress) {
  std::size_t own_in_flight = 0;
  Hand hand(list);
  now_ = Clock::now();
  while (!hand.all_done()) {
    for (int rank = 1; rank < size_; ++rank) {
      Rank& other = others_[static_cast<std::size_t>(rank)];
      if (!other.ready) continue;
      hand.fill(other.in_flight, [&](std::size_t task, const std::string& key) {
        mailbox_.send(rank, Kind::task, tasks::ByteWriter().put(std::uint64_t{task}).take() + key);
      });
    }
    hand.fill(own_in_flight, [&own](std::size_t task, std::string key) { own.add(task, std::move(key)); });
    while (const auto message = mailbox_.receive()) {
      Rank& other = others_[static_cast<std::size_t>(message->rank)];
      other.silence.heard();
      if (message->kind == Kind::ready) {
        if (auto error = receive_ready(*message, job)) return error;
      } else if (message->kind == Kind::failed) {
        Error error = error_of(message->bytes);
        error.message = name_of(message->rank) + ": " + error.message;
        return error;
      } else if (message->kind == Kind::value) {
        tasks::ByteReader reader(message->bytes);
        const auto task = reader.get<std::uint64_t>();
        hand.finished(reader.get<double>());
        --other.in_flight;
        if (auto error = take(static_cast<std::size_t>(task), reader.rest())) return error;
      }
    }
    for (const auto& done : own.done(nap)) {
      if (!done.value) return done.value.error();
      hand.finished(done.took_s);
      --own_in_flight;
      if (auto error = take(static_cast<std::size_t>(done.task), *done.value)) return error;
    }
    stay_in_touch();
    if (list.count > 0) progress(hand.share());
  }
  progress(1.0);
  return {};
}

void Session::Ranks::finish() {
  if (std::exchange(ended_, true)) return;
  for (int rank = 1; rank < size_; ++rank) mailbox_.send(rank, Kind::end);
}

/// In a rank that does not lead: the same as `stay_in_touch`.
void Session::Ranks::follow(bool& ended) {
  const auto now = Clock::now();
  Silence& silence = others_[0].silence;
  silence.pass(seconds(now - std::exchange(now_, now)));
  if (ended) return;
  if (silence.lasted_s() > (led_ ? silence_limit_s : start_limit_s)) give_up(0);
  if (seconds(now - last_sent_) < alive_every_s) return;
  last_sent_ = now;
  mailbox_.send(0, Kind::alive);
}

Check Session::Ranks::serve(const tasks::Job& job) {
  mailbox_.send(0, Kind::ready,
                tasks::ByteWriter().put(hash_of(job.description)).put(std::string_view(own_name(rank_))).take());
  ComputingThread own(job);
  std::size_t in_flight = 0;
  now_ = Clock::now();
  while (!ended_) {
    while (auto message = mailbox_.receive()) {
      others_[0].silence.heard();
      led_ = true;
      if (message->kind == Kind::end) ended_ = true;
      if (message->kind != Kind::task) continue;
      tasks::ByteReader reader(message->bytes);
      const auto task = reader.get<std::uint64_t>();
      own.add(task, std::string(reader.rest()));
      ++in_flight;
    }
    for (auto& done : own.done(nap)) {
      --in_flight;
      if (!done.value) {
        mailbox_.send(0, Kind::failed, to_bytes(done.value.error()));
      } else {
        mailbox_.send(0, Kind::value, tasks::ByteWriter().put(done.task).put(done.took_s).take() + *done.value);
      }
    }
    follow(ended_);
  }
  if (in_flight > 0) leave_at_once();
  return {};
}

/// The job has ended early, and nobody waits for the task that this rank still runs.
void Session::Ranks::leave_at_once() {
  part();
  MPI_Finalize();
  std::_Exit(0);
}

void Session::Ranks::report_failure(const std::string& messages) {
  mailbox_.send(0, Kind::failed, to_bytes(failed(messages)));
  now_ = Clock::now();
  while (!ended_) {
    while (const auto message = mailbox_.receive()) {
      others_[0].silence.heard();
      led_ = true;
      if (message->kind == Kind::end) ended_ = true;
    }
    usleep(static_cast<useconds_t>(std::chrono::microseconds(nap).count()));
    follow(ended_);
  }
}

void Session::Ranks::part() {
  if (leads()) {
    finish();
  } else {
    mailbox_.send(0, Kind::gone);
  }
  const auto start = Clock::now();
  const auto missing = [this] {
    if (!leads()) return false;
    return std::any_of(others_.begin() + 1, others_.end(), [](const Rank& other) { return !other.gone; });
  };
  while (missing() || !mailbox_.sent()) {
    while (const auto message = mailbox_.receive()) {
      if (message->kind == Kind::gone) others_[static_cast<std::size_t>(message->rank)].gone = true;
    }
    if (!missing() && mailbox_.sent()) return;
    if (seconds(Clock::now() - start) > part_limit_s) {
      for (int rank = 1; leads() && rank < size_; ++rank) {
        if (!others_[static_cast<std::size_t>(rank)].gone) give_up(rank);
      }
      return;
    }
    usleep(static_cast<useconds_t>(std::chrono::microseconds(nap).count()));
  }
}

}  // namespace tactus::ranks
