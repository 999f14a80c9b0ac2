// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/ros2/participant.hpp>

#include <atomic>
#include <cmath>
#include <iostream>
#include <memory>
#include <string_view>

#include <dds/dds.h>
#include <dds/ddsrt/log.h>
#include <ros2_types.h>

namespace tactus::ros2 {

namespace {

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::int32_t kept = 10;
/// How long a writer waits for a reliable reader that does not take in what it is sent.
constexpr std::int64_t timeout_ns = 10'000'000;
/// No message of ours has a thousandth of it, and a stranger must not make this process allocate what he likes.
constexpr const char* size_limit = "<CycloneDDS><Domain><Internal><MaxSampleSize>64kB</></></></>";
/// Loopback has no multicast here: everyone is asked at the ports of the first participants of the domain.
constexpr const char* loopback =
    "<CycloneDDS><Domain>"
    "<General><Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces><AllowMulticast>false</></>"
    "<Discovery><ParticipantIndex>auto</><MaxAutoParticipantIndex>32</>"
    "<Peers><Peer address=\"127.0.0.1\"/></></>"
    "</></>";

/// Lines that Cyclone may write to standard error. It has one for each malformed packet, so a stranger could fill
/// disks.
constexpr int most_lines = 20;
thread_local std::string* collected = nullptr;

void on_log(void*, const dds_log_data_t* line) {
  static std::atomic<int> lines{0};
  if (collected != nullptr) {
    collected->append(line->message, line->size);
  } else if (const int before = lines.fetch_add(1); before < most_lines) {
    std::cerr << "DDS: " << std::string_view(line->message, line->size) << "\n"
              << (before == most_lines - 1 ? "DDS: further messages are not shown\n" : "");
  }
}

/// What Cyclone has to say to this thread while it is asked to do something, for an error.
class Complaints {
 public:
  Complaints() { collected = &text_; }
  Complaints(const Complaints&) = delete;
  Complaints& operator=(const Complaints&) = delete;
  ~Complaints() { collected = nullptr; }

  /// The first line of it, or what the code says.
  [[nodiscard]] std::string about(dds_return_t code) const {
    return text_.empty() ? std::string(dds_strretcode(-code)) : text_.substr(0, text_.find('\n'));
  }

 private:
  std::string text_;
};

Error failed(const std::string& what, const std::string& why) {
  return {.code = ErrorCode::failed, .parameter = {}, .message = what + ": " + why, .place = {}};
}

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

void announce(dds_qos_t* qos, const std::string& text) { dds_qset_userdata(qos, text.data(), text.size()); }

/// What ROS 2 uses where nobody asks for something else, and the type's hash, which it compares from Iron on.
Qos endpoint_qos(dds_reliability_kind_t reliability, const char* type_hash) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), reliability, timeout_ns);
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kept);
  announce(qos.get(), std::string("typehash=") + type_hash + ";");
  return qos;
}

// Strings and sequences of what is sent point into the message; DDS only reads them.
char* borrowed(const std::string& text) { return const_cast<char*>(text.c_str()); }
dds_sequence_double borrowed(const std::vector<double>& values) {
  const auto length = static_cast<std::uint32_t>(values.size());
  return {._maximum = length, ._length = length, ._buffer = const_cast<double*>(values.data()), ._release = false};
}
std::vector<double> copied(const dds_sequence_double& values) {
  return {values._buffer, values._buffer + values._length};
}
std::string copied(const char* text) { return text == nullptr ? std::string() : std::string(text); }

std_msgs_msg_dds__Header_ header_of(std::int64_t stamp_ns, const std::string& frame_id) {
  return {.stamp = {.sec = static_cast<std::int32_t>(stamp_ns / second_ns),
                    .nanosec = static_cast<std::uint32_t>(stamp_ns % second_ns)},
          .frame_id = borrowed(frame_id)};
}
std::int64_t stamp_of(const std_msgs_msg_dds__Header_& header) {
  return header.stamp.sec * second_ns + header.stamp.nanosec;
}

/// How a message of ours and one of Cyclone's become one another.
template <class Message>
struct Wire;

template <>
struct Wire<JointState> {
  using Type = sensor_msgs_msg_dds__JointState_;
  static constexpr const dds_topic_descriptor_t* descriptor = &sensor_msgs_msg_dds__JointState__desc;
  static dds_return_t write(dds_entity_t writer, const JointState& message) {
    std::vector<char*> names;
    names.reserve(message.name.size());
    for (const std::string& name : message.name) names.push_back(borrowed(name));
    const auto count = static_cast<std::uint32_t>(names.size());
    const Type sample{.header = header_of(message.stamp_ns, message.frame_id),
                      .name = {._maximum = count, ._length = count, ._buffer = names.data(), ._release = false},
                      .position = borrowed(message.position),
                      .velocity = borrowed(message.velocity),
                      .effort = borrowed(message.effort)};
    return dds_write(writer, &sample);
  }
  static JointState read(const Type& sample) {
    JointState message{.stamp_ns = stamp_of(sample.header),
                       .frame_id = copied(sample.header.frame_id),
                       .name = {},
                       .position = copied(sample.position),
                       .velocity = copied(sample.velocity),
                       .effort = copied(sample.effort)};
    for (std::uint32_t i = 0; i < sample.name._length; ++i) message.name.push_back(copied(sample.name._buffer[i]));
    return message;
  }
};

template <>
struct Wire<WrenchStamped> {
  using Type = geometry_msgs_msg_dds__WrenchStamped_;
  static constexpr const dds_topic_descriptor_t* descriptor = &geometry_msgs_msg_dds__WrenchStamped__desc;
  static dds_return_t write(dds_entity_t writer, const WrenchStamped& message) {
    const auto& [fx, fy, fz] = message.force_N;
    const auto& [tx, ty, tz] = message.torque_Nm;
    const Type sample{.header = header_of(message.stamp_ns, message.frame_id),
                      .wrench = {.force = {.x = fx, .y = fy, .z = fz}, .torque = {.x = tx, .y = ty, .z = tz}}};
    return dds_write(writer, &sample);
  }
  static WrenchStamped read(const Type& sample) {
    const auto& [force, torque] = sample.wrench;
    return {.stamp_ns = stamp_of(sample.header),
            .frame_id = copied(sample.header.frame_id),
            .force_N = {force.x, force.y, force.z},
            .torque_Nm = {torque.x, torque.y, torque.z}};
  }
};

template <>
struct Wire<Text> {
  using Type = std_msgs_msg_dds__String_;
  static constexpr const dds_topic_descriptor_t* descriptor = &std_msgs_msg_dds__String__desc;
  static dds_return_t write(dds_entity_t writer, const Text& message) {
    const Type sample{.data = borrowed(message.data)};
    return dds_write(writer, &sample);
  }
  static Text read(const Type& sample) { return {.data = copied(sample.data)}; }
};

template <class Message>
Result<dds_entity_t> open_topic(dds_entity_t participant, const std::string& topic) {
  const Complaints complaints;
  const dds_entity_t handle = dds_create_topic(participant, Wire<Message>::descriptor, topic.c_str(), nullptr, nullptr);
  if (handle < 0) return failed("the DDS topic " + topic + " could not be made", complaints.about(handle));
  return handle;
}

}  // namespace

Result<Participant> Participant::create(const Network& network) {
  std::string configuration = size_limit;
  const std::string more = network.loopback_only ? std::string(loopback) : network.configuration;
  if (!more.empty()) configuration += "," + more;
  const std::string where = "DDS domain " + std::to_string(network.domain);
  const Complaints complaints;
  dds_set_log_sink(&on_log, nullptr);
  const dds_entity_t domain = dds_create_domain(network.domain, configuration.c_str());
  if (domain == DDS_RETCODE_PRECONDITION_NOT_MET) {
    return failed(where, "this process takes part in it already: use the participant that there is");
  }
  const std::string remedy = "; check the network and CYCLONEDDS_URI, or set ROS_LOCALHOST_ONLY=1 to do without both";
  if (domain < 0) return failed(where + " could not be joined", complaints.about(domain) + remedy);
  const Qos qos(dds_create_qos());
  announce(qos.get(), "enclave=/;");
  const dds_entity_t participant = dds_create_participant(network.domain, qos.get(), nullptr);
  if (participant < 0) {
    Error error = failed(where + " could not be joined", complaints.about(participant) + remedy);
    dds_delete(domain);
    return error;
  }
  return Participant(domain, participant);
}

Participant::~Participant() {
  if (domain_ > 0) dds_delete(domain_);
}

template <class Message>
Result<Writer<Message>> Participant::writer(const std::string& topic) {
  const auto on = open_topic<Message>(handle_, topic);
  if (!on) return on.error();
  const Complaints complaints;
  const Qos qos = endpoint_qos(DDS_RELIABILITY_RELIABLE, Message::type_hash);
  const dds_entity_t writer = dds_create_writer(handle_, *on, qos.get(), nullptr);
  if (writer < 0) return failed("the DDS topic " + topic + " cannot be written", complaints.about(writer));
  return Writer<Message>(writer);
}

template <class Message>
Result<Reader<Message>> Participant::reader(const std::string& topic) {
  const auto on = open_topic<Message>(handle_, topic);
  if (!on) return on.error();
  const Complaints complaints;
  const Qos qos = endpoint_qos(DDS_RELIABILITY_BEST_EFFORT, Message::type_hash);
  const dds_entity_t reader = dds_create_reader(handle_, *on, qos.get(), nullptr);
  if (reader < 0) return failed("the DDS topic " + topic + " cannot be read", complaints.about(reader));
  const dds_entity_t condition = dds_create_readcondition(reader, DDS_ANY_STATE);
  const dds_entity_t waitset = dds_create_waitset(handle_);
  if (const dds_return_t attached = dds_waitset_attach(waitset, condition, 0); attached < 0) {
    return failed("the DDS topic " + topic + " cannot be read", complaints.about(attached));
  }
  return Reader<Message>(reader, waitset);
}

template <class Message>
Check Writer<Message>::write(const Message& message) {
  const dds_return_t done = Wire<Message>::write(handle_, message);
  if (done < 0) return failed("a message could not be sent", dds_strretcode(-done));
  return std::nullopt;
}

template <class Message>
std::size_t Writer<Message>::readers() const {
  dds_publication_matched_status_t status{};
  dds_get_publication_matched_status(handle_, &status);
  return status.current_count;
}

template <class Message>
std::vector<Message> Reader<Message>::take() {
  void* samples[kept]{};
  dds_sample_info_t about[kept];
  const dds_return_t taken = dds_take(handle_, samples, about, kept, kept);
  std::vector<Message> messages;
  for (dds_return_t i = 0; i < taken; ++i) {
    // Not valid: news about a writer that has gone.
    if (about[i].valid_data) {
      messages.push_back(Wire<Message>::read(*static_cast<const typename Wire<Message>::Type*>(samples[i])));
    }
  }
  if (taken > 0) dds_return_loan(handle_, samples, taken);
  return messages;
}

template <class Message>
void Reader<Message>::wait(Seconds longest) const {
  dds_attach_t ready = 0;
  dds_waitset_wait(waitset_, &ready, 1, std::llround(longest.value * 1e9));
}

template <class Message>
std::size_t Reader<Message>::writers() const {
  dds_subscription_matched_status_t status{};
  dds_get_subscription_matched_status(handle_, &status);
  return status.current_count;
}

template Result<Writer<JointState>> Participant::writer(const std::string&);
template Result<Writer<WrenchStamped>> Participant::writer(const std::string&);
template Result<Writer<Text>> Participant::writer(const std::string&);
template Result<Reader<JointState>> Participant::reader(const std::string&);
template Result<Reader<WrenchStamped>> Participant::reader(const std::string&);
template Result<Reader<Text>> Participant::reader(const std::string&);
template class Writer<JointState>;
template class Writer<WrenchStamped>;
template class Writer<Text>;
template class Reader<JointState>;
template class Reader<WrenchStamped>;
template class Reader<Text>;

}  // namespace tactus::ros2
