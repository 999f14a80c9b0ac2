// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/interfaces/live/server.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "raw_client.hpp"
#include "sample_view.hpp"
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <tests/sanitizers.hpp>
#include <tests/scratch_path.hpp>

namespace tactus::live {
namespace {

/// A view behind a server on a free port, its loops stepped by a thread as fast as the test wants.
class Served {
 public:
  explicit Served(ServerOptions options = {}, StaticFiles page = {}, bool allow_tuning = true)
      : view_(sample_view(allow_tuning)) {
    options.port = 0;
    server_.emplace(Server::start(options, std::move(page), *view_).value());
  }
  ~Served() { stop(); }

  [[nodiscard]] std::uint16_t port() const { return server_->port(); }
  [[nodiscard]] Server& server() { return *server_; }
  void run() {
    loop_ = std::thread([this] { view_->engine().run([this] { return !stop_; }); });
  }
  void stop() {
    stop_ = true;
    if (loop_.joinable()) loop_.join();
  }

 private:
  std::unique_ptr<LiveView> view_;
  std::optional<Server> server_;
  std::atomic<bool> stop_{false};
  std::thread loop_;
};

std::string host_of(std::uint16_t port) { return "Host: 127.0.0.1:" + std::to_string(port) + "\r\n"; }

/// The answer to a request line and more header lines, with the right host unless `host` says else.
std::string answer(std::uint16_t port, const std::string& line, const std::string& more = "", std::string host = "-") {
  RawClient client(port);
  if (host == "-") host = host_of(port);
  client.send(line + " HTTP/1.1\r\n" + host + more + "\r\n");
  return client.receive_all();
}

TEST(Server, ServesTheFilesOfThePageAndNothingElse) {
  const auto folder = scratch_path();
  std::filesystem::create_directories(folder / "assets");
  std::filesystem::create_directories(folder / ".git");
  std::ofstream(folder / "index.html") << "<!doctype html>page";
  std::ofstream(folder / "assets/page.js") << "let x;";
  std::ofstream(folder / ".git/secret") << "secret";
  const std::filesystem::path outside = folder.string() + "_outside.txt";
  std::ofstream(outside) << "secret";
  std::filesystem::remove(folder / "link");
  std::filesystem::create_symlink(outside, folder / "link");
  Served served({}, StaticFiles::load(folder).value());
  const std::uint16_t port = served.port();

  for (const char* target : {"GET /", "GET /index.html", "GET /?theme=dark"}) {
    const std::string page = answer(port, target);
    EXPECT_TRUE(page.starts_with("HTTP/1.1 200 OK")) << page;
    EXPECT_NE(page.find("Content-Type: text/html; charset=utf-8\r\n"), std::string::npos);
    EXPECT_NE(page.find("X-Content-Type-Options: nosniff\r\n"), std::string::npos);
    EXPECT_TRUE(page.ends_with("\r\n\r\n<!doctype html>page"));
  }
  EXPECT_NE(answer(port, "GET /assets/page.js").find("Content-Type: text/javascript"), std::string::npos);
  const std::string head = answer(port, "HEAD /");
  EXPECT_TRUE(head.starts_with("HTTP/1.1 200 OK"));
  EXPECT_NE(head.find("Content-Length: 19\r\n"), std::string::npos);
  EXPECT_TRUE(head.ends_with("\r\n\r\n"));
  EXPECT_TRUE(answer(port, "GET /healthz").ends_with("\r\n\r\nok\n"));
  for (const char* target :
       {"GET /../outside.txt", "GET /%2e%2e/page_outside.txt", "GET //etc/passwd", "GET /.git/secret", "GET /link",
        "GET /assets", "GET /assets/../index.html", "GET \\index.html"}) {
    const std::string refused = answer(port, target);
    EXPECT_TRUE(refused.starts_with("HTTP/1.1 40")) << target << ": " << refused;
    EXPECT_EQ(refused.find("secret\n"), std::string::npos);
  }
  EXPECT_TRUE(answer(port, "POST /").starts_with("HTTP/1.1 405"));
  EXPECT_TRUE(answer(port, "DELETE /index.html").starts_with("HTTP/1.1 405"));
}

TEST(Server, AFolderWithoutAPageIsRefused) {
  const auto folder = scratch_path();
  std::filesystem::create_directories(folder);
  const auto page = StaticFiles::load(folder);
  ASSERT_FALSE(page);
  EXPECT_NE(page.error().message.find("index.html"), std::string::npos);
  EXPECT_FALSE(StaticFiles::load(folder / "nowhere"));
}

TEST(Server, OtherHostsAndOriginsReachNothing) {
  Served served;
  const std::uint16_t port = served.port();
  const std::string number = std::to_string(port);
  for (const std::string host : {"", "Host: evil.example\r\n", "Host: 127.0.0.1\r\n", "Host: 127.0.0.1:1\r\n"}) {
    EXPECT_TRUE(answer(port, "GET /healthz", "", host).starts_with("HTTP/1.1 421")) << host;
  }
  const std::string twice = host_of(port) + "Host: evil.example\r\n";
  EXPECT_FALSE(answer(port, "GET /healthz", "", twice).starts_with("HTTP/1.1 200"));
  for (const std::string name : {"127.0.0.1", "localhost", "[::1]"}) {
    const std::string host = "Host: " + name + ":" + number + "\r\n";
    EXPECT_TRUE(answer(port, "GET /healthz", "", host).starts_with("HTTP/1.1 200"));
    EXPECT_TRUE(answer(port, "GET /healthz", "Origin: http://" + name + ":" + number + "\r\n", host)
                    .starts_with("HTTP/1.1 200"));
  }
  for (const std::string origin : {"http://evil.example", "null", "http://127.0.0.1", "https://127.0.0.1"}) {
    RawClient client(port);
    EXPECT_FALSE(client.open(port, "foxglove.websocket.v1", "Origin: " + origin + "\r\n")) << origin;
  }
  RawClient own(port);
  EXPECT_TRUE(own.open(port, "foxglove.websocket.v1", "Origin: http://127.0.0.1:" + number + "\r\n"));
}

TEST(Server, SpeaksBothSubprotocolsAndNoOther) {
  Served served;
  for (const char* name : {"foxglove.sdk.v1", "foxglove.websocket.v1"}) {
    RawClient client(served.port());
    ASSERT_TRUE(client.open(served.port(), name));
    EXPECT_TRUE(client.text_with("serverInfo").has_value());
    EXPECT_TRUE(client.text_with("\"advertise\"").has_value());
  }
  RawClient other(served.port());
  EXPECT_FALSE(other.open(served.port(), "mqtt"));
}

TEST(Server, APortInUseIsAnErrorThatSaysSo) {
  Served served;
  const auto view = sample_view();
  const auto second = Server::start({.port = served.port(), .conversation = {}}, {}, *view);
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find("another port"), std::string::npos);
  EXPECT_EQ(second.error().place, "127.0.0.1:" + std::to_string(served.port()));
  EXPECT_FALSE(Server::start({.address = "0.0.0.0", .port = 0, .conversation = {}}, {}, *view));
  EXPECT_FALSE(Server::start({.address = "no address", .port = 0, .conversation = {}}, {}, *view));
}

TEST(Server, AClientSeesTheLoopsAndMovesThemAndOthersSeeTheParametersChange) {
  Served served;
  served.run();
  RawClient client(served.port());
  RawClient other(served.port());
  ASSERT_TRUE(client.open(served.port()));
  ASSERT_TRUE(other.open(served.port()));
  other.say(R"({"op":"subscribeParameterUpdates","parameterNames":[]})");
  // The answer shows that the request before it was taken.
  other.say(R"({"op":"getParameters","parameterNames":[],"id":"all"})");
  ASSERT_TRUE(other.text_with("\"all\"").has_value());

  client.say(R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":3}]})");
  client.say(
      R"({"op":"advertise","channels":[{"id":1,"topic":"/operator/command","encoding":"json","schemaName":""}]})");
  client.say_binary(std::string("\x01\x01\x00\x00\x00", 5) + R"({"command":"tap"})");
  std::size_t states = 0;
  bool settled = false;
  while (const auto message = client.next()) {
    if (!message->binary) continue;
    ASSERT_EQ(message->content.substr(0, 5), std::string("\x01\x09\x00\x00\x00", 5));
    ++states;
    settled = message->content.find("settled") != std::string::npos;
    if (settled || states > 2000) break;
  }
  EXPECT_TRUE(settled);
  client.say(R"({"op":"setParameters","parameters":[{"name":"control.force_gain","value":3}]})");
  const auto told = other.text_with("control.force_gain");
  ASSERT_TRUE(told.has_value());
  EXPECT_NE(told->find("3.0"), std::string::npos);
}

TEST(Server, MoreClientsThanAllowedAreTurnedAwayAndTheOthersServed) {
  Served served({.clients = 10, .conversation = {}});
  served.run();
  std::vector<RawClient> clients;
  std::size_t opened = 0;
  for (int i = 0; i < 50; ++i) {
    clients.emplace_back(served.port());
    opened += clients.back().open(served.port()) ? 1U : 0U;
  }
  EXPECT_EQ(opened, 10U);
  EXPECT_EQ(served.server().counts().turned_away, 40U);
  EXPECT_TRUE(clients.front().text_with("serverInfo").has_value());
  clients.clear();
  // The room is free again once the server has seen them go.
  bool again = false;
  for (int i = 0; i < 100 && !again; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    RawClient late(served.port());
    again = late.open(served.port());
  }
  EXPECT_TRUE(again);
}

/// Every tick of a loop is in the log, and is what the loop does alone, to the last bit: nobody moved the hand.
void expect_the_log_of_a_loop_alone(const std::filesystem::path& file) {
  auto alone = simulation::Teleoperator::make(sample_params(0), 0.0).value();
  const auto content = telemetry::read_log(file, "/left/teleoperator").value();
  ASSERT_EQ(content.tables.size(), 1U);
  const auto& table = content.tables.front();
  EXPECT_EQ(table.missing, 0U);
  const auto& master_m = table.values[1];
  ASSERT_GT(master_m.size(), 100U);
  for (const double position_m : master_m) ASSERT_EQ(alone.step(0.0, 0.0).master_position_m, position_m);
}

// The thread sanitizer makes everything some twenty times slower. It finds the same with less at once.
constexpr bool slowed_down = TACTUS_UNDER_THREAD_SANITIZER != 0;

TEST(Server, SlowAndDeadClientsCostTheLoopNothingAndTheirLossesAreCounted) {
  const auto file = scratch_path();
  const auto view = sample_view();
  auto log = telemetry::Recorder::create(file).value();
  view->engine().log_to(log);
  log.start();
  {
    ServerOptions options{.port = 0, .silence_s = 0.5, .conversation = {}};
    options.conversation.outbox = {.frames = 200, .bytes = 100000};
    const Server server = Server::start(options, {}, *view).value();
    std::vector<RawClient> slow;
    for (int i = 0; i < (slowed_down ? 4 : 20); ++i) {
      slow.emplace_back(server.port());
      slow.back().read_little();
      ASSERT_TRUE(slow.back().open(server.port()));
      slow.back().say(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":4},{"id":2,"channelId":8}]})");
    }
    const auto start = std::chrono::steady_clock::now();
    const auto elapsed_s = [start] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    // Long enough for the silent ones to be closed, unless the machine takes longer.
    view->engine().run([&] { return elapsed_s() < 1.0 || (server.counts().clients > 0 && elapsed_s() < 60.0); });
    EXPECT_GT(server.counts().dropped, 0U);
    EXPECT_EQ(server.counts().clients, 0U) << "none answered a ping";
  }
  EXPECT_FALSE(log.stop());
  for (const std::uint64_t dropped : log.dropped()) EXPECT_EQ(dropped, 0U);
  expect_the_log_of_a_loop_alone(file);
}

TEST(Server, AThousandClientsCostTheLoopNothingAndSixtyFourOfThemAreServed) {
  constexpr std::size_t room = 64;
  rlimit descriptors{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &descriptors), 0);
  // Both ends of each connection are in this process.
  descriptors.rlim_cur = std::max<rlim_t>(descriptors.rlim_cur, 2200);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &descriptors), 0) << "open files are limited to less: ulimit -Hn";
  const auto file = scratch_path();
  const auto view = sample_view();
  auto log = telemetry::Recorder::create(file).value();
  view->engine().log_to(log);
  log.start();
  {
    // So long that nobody is closed for silence while all are held, however slow the machine.
    const Server server =
        Server::start({.port = 0, .clients = room, .silence_s = 3600.0, .conversation = {}}, {}, *view).value();
    std::atomic<bool> stop{false};
    std::thread loop([&] { view->engine().run([&stop] { return !stop; }); });
    std::vector<RawClient> clients;
    clients.reserve(1000);
    std::size_t turned_away = 0;
    const std::string channel = slowed_down ? "1" : "4";  // 50 messages a second, or one a tick
    for (std::size_t i = 0; i < 1000; ++i) {
      RawClient& client = clients.emplace_back(server.port());
      if (i < room) {
        EXPECT_TRUE(client.open(server.port())) << i;
        client.say(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":)" + channel + "}]}");
      } else {
        if (!client.receive_all(10000).starts_with("HTTP/1.1 503 ")) break;
        ++turned_away;
      }
    }
    EXPECT_EQ(turned_away, 1000 - room);
    EXPECT_EQ(server.counts().turned_away, 1000 - room);
    EXPECT_EQ(server.counts().clients, room);
    // All are held for a while.
    std::this_thread::sleep_for(std::chrono::seconds(1));
    stop = true;
    loop.join();
  }
  EXPECT_FALSE(log.stop());
  for (const std::uint64_t dropped : log.dropped()) EXPECT_EQ(dropped, 0U);
  expect_the_log_of_a_loop_alone(file);
}

/// What someone who comes now has to wait for: the greeting, and the first state of a loop.
void expect_served(std::uint16_t port, const char* when) {
  constexpr int patient_ms = 20000;
  const auto came = std::chrono::steady_clock::now();
  RawClient fresh(port);
  ASSERT_TRUE(fresh.open(port)) << when;
  EXPECT_TRUE(fresh.text_with("serverInfo", patient_ms).has_value()) << when;
  fresh.say(R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":3}]})");
  while (const auto message = fresh.next(patient_ms)) {
    if (!message->binary) continue;
    EXPECT_LT(std::chrono::steady_clock::now() - came, std::chrono::milliseconds(patient_ms)) << when;
    return;
  }
  ADD_FAILURE() << "no state " << when;
}

TEST(Server, AFloodOfSubscriptionsKeepsNobodyElseFromAnswersAndIsForgottenAfterIt) {
  ServerOptions options;
  options.conversation.subscriptions = 256;
  Served served(options);
  served.run();
  {
    std::vector<RawClient> flood;
    for (int i = 0; i < 8; ++i) {
      ASSERT_TRUE(flood.emplace_back(served.port()).open(served.port()));
      flood.back().say(subscribe_often("4", 256));
    }
    while (served.server().counts().dropped == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    expect_served(served.port(), "in the flood");
  }
  expect_served(served.port(), "after the flood");
}

TEST(Server, LongHeadsLongFramesAndSilenceAreCutOff) {
  Served served({.frame_bytes = 1000, .header_bytes = 1000, .request_within_s = 0.3, .conversation = {}});
  EXPECT_TRUE(
      answer(served.port(), "GET /healthz", "X: " + std::string(2000, 'x') + "\r\n").starts_with("HTTP/1.1 431"));
  RawClient silent(served.port());
  silent.send("GET / HT");
  EXPECT_EQ(silent.receive_all(5000), "") << "closed without an answer";
  RawClient long_winded(served.port());
  ASSERT_TRUE(long_winded.open(served.port()));
  long_winded.say(std::string(2000, ' '));
  while (long_winded.next()) {
  }
  EXPECT_TRUE(answer(served.port(), "GET /healthz").starts_with("HTTP/1.1 200"));
}

/// Requests and frames with bytes changed, cut and doubled. Whatever the answer, the server must go on.
TEST(Server, SurvivesAnyBytes) {
  Served served({.request_within_s = 0.2, .conversation = {}});
  served.run();
  const std::string handshake =
      "GET / HTTP/1.1\r\n" + host_of(served.port()) +
      "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
      "dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n";
  const std::vector<std::string> seeds{
      "GET /index.html HTTP/1.1\r\n" + host_of(served.port()) + "\r\n",
      handshake,
      RawClient::frame(1, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})"),
      RawClient::frame(2, std::string("\x01\x01\x00\x00\x00{}", 7)),
      RawClient::frame(8, "\x03\xe8"),
      RawClient::frame(9, "ping"),
      std::string("\x81\xff\xff\xff\xff\xff\xff\xff\xff\xff", 10)};
  signal::Random random(7);
  const auto below = [&random](std::size_t end) { return static_cast<std::size_t>(random.bits() % end); };
  for (int i = 0; i < 200; ++i) {
    RawClient client(served.port());
    ASSERT_TRUE(client.connected()) << i;
    if (i % 2 == 0) client.open(served.port(), "foxglove.sdk.v1");
    for (std::size_t pieces = 1 + below(4); pieces > 0; --pieces) {
      std::string bytes = seeds[below(seeds.size())];
      for (std::size_t changes = below(4); changes > 0 && !bytes.empty(); --changes) {
        const std::size_t at = below(bytes.size());
        if (below(2) == 0) {
          bytes[at] = static_cast<char>(below(256));
        } else {
          bytes.erase(at, below(6));
        }
      }
      if (!client.send(bytes)) break;
    }
  }
  EXPECT_TRUE(answer(served.port(), "GET /healthz").starts_with("HTTP/1.1 200"));
}

}  // namespace
}  // namespace tactus::live
