// SPDX-License-Identifier: Apache-2.0
#include "tests/ros2/fast_dds_peer.hpp"

#include <cstring>
#include <mutex>
#include <stdexcept>

#include "tests/ros2/test_network.hpp"
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

namespace tactus::ros2::test {

namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::size_t most_bytes = 200'000;

/// Any type of a given name as the bytes that go over the wire.
class RawType final : public dds::TopicDataType {
 public:
  explicit RawType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = most_bytes;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const Bytes& bytes = *static_cast<const Bytes*>(data);
    payload->reserve(static_cast<std::uint32_t>(bytes.size()));
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size()); };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

/// A message that is being read.
struct Reading {
  explicit Reading(const Bytes& message) : bytes(message) { cdr.read_encapsulation(); }
  Bytes bytes;
  FastBuffer buffer{reinterpret_cast<char*>(bytes.data()), bytes.size()};
  Cdr cdr{buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR};
};

void read_header(Cdr& cdr, std::int64_t& stamp_ns, std::string& frame_id) {
  std::int32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  cdr >> seconds >> nanoseconds >> frame_id;
  stamp_ns = seconds * second_ns + nanoseconds;
}

}  // namespace

Bytes to_fast_cdr(const JointState& message) {
  FastBuffer buffer;
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  cdr << static_cast<std::int32_t>(message.stamp_ns / second_ns)
      << static_cast<std::uint32_t>(message.stamp_ns % second_ns) << message.frame_id << message.name
      << message.position << message.velocity << message.effort;
  const auto* const begin = reinterpret_cast<const unsigned char*>(buffer.getBuffer());
  return {begin, begin + cdr.getSerializedDataLength()};
}

JointState joint_state_of(const Bytes& bytes) {
  Reading reading(bytes);
  JointState message;
  read_header(reading.cdr, message.stamp_ns, message.frame_id);
  reading.cdr >> message.name >> message.position >> message.velocity >> message.effort;
  return message;
}

WrenchStamped wrench_of(const Bytes& bytes) {
  Reading reading(bytes);
  WrenchStamped message;
  read_header(reading.cdr, message.stamp_ns, message.frame_id);
  reading.cdr >> message.force_N >> message.torque_Nm;
  return message;
}

Text text_of(const Bytes& bytes) {
  Reading reading(bytes);
  Text message;
  reading.cdr >> message.data;
  return message;
}

struct FastDdsPeer::State final : dds::DomainParticipantListener {
  dds::DomainParticipant* participant = nullptr;
  dds::Publisher* publisher = nullptr;
  dds::Subscriber* subscriber = nullptr;
  std::map<std::string, dds::Topic*> topics;
  std::map<std::string, dds::DataReader*> readers;
  std::map<std::string, dds::DataWriter*> writers;
  std::map<std::string, std::vector<Bytes>> received;
  std::mutex mutex;
  std::map<std::string, Announcement> announced;

  template <class Info>
  void note(const Info& info, bool writes) {
    // Fast DDS announces its own readers and writers too.
    if (participant != nullptr && info.guid().guidPrefix == participant->guid().guidPrefix) return;
    // Among a hundred domains another test's process may have the same.
    const std::string name = info.topicName().to_string();
    if (name.find("/" + private_namespace() + "/") == std::string::npos) return;
    const auto& user_data = info.m_qos.m_userData;
    const std::scoped_lock lock(mutex);
    announced[name] = {.type = info.typeName().to_string(),
                       .user_data = std::string(user_data.begin(), user_data.end()),
                       .reliable = info.m_qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS,
                       .is_volatile = info.m_qos.m_durability.kind == dds::VOLATILE_DURABILITY_QOS,
                       .writes = writes};
  }
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& found) override {
    note(found.info, true);
  }
  void on_subscriber_discovery(dds::DomainParticipant*, rtps::ReaderDiscoveryInfo&& found) override {
    note(found.info, false);
  }

  dds::Topic* topic(const std::string& name, const std::string& type) {
    dds::TypeSupport(new RawType(type)).register_type(participant);
    dds::Topic*& known = topics[name];
    if (known == nullptr) known = participant->create_topic(name, type, dds::TOPIC_QOS_DEFAULT);
    return known;
  }
};

FastDdsPeer::FastDdsPeer(std::uint32_t domain) : state_(std::make_unique<State>()) {
  dds::DomainParticipantQos qos;
  const auto loopback = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  loopback->interfaceWhiteList.emplace_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(loopback);
  rtps::Locator_t everyone;
  rtps::IPLocator::setIPv4(everyone, 127, 0, 0, 1);
  qos.wire_protocol().builtin.initialPeersList.push_back(everyone);
  state_->participant = dds::DomainParticipantFactory::get_instance()->create_participant(domain, qos, state_.get(),
                                                                                          dds::StatusMask::none());
  if (state_->participant == nullptr) throw std::runtime_error("Fast DDS could not join the domain");
  state_->publisher = state_->participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  state_->subscriber = state_->participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
}

FastDdsPeer::~FastDdsPeer() {
  state_->participant->set_listener(nullptr);
  state_->participant->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(state_->participant);
}

void FastDdsPeer::subscribe(const std::string& topic, const std::string& type) {
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  state_->readers[topic] = state_->subscriber->create_datareader(state_->topic(topic, type), qos);
}

void FastDdsPeer::advertise(const std::string& topic, const std::string& type) {
  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  state_->writers[topic] = state_->publisher->create_datawriter(state_->topic(topic, type), qos);
}

std::vector<Bytes> FastDdsPeer::received(const std::string& topic) {
  std::vector<Bytes>& all = state_->received[topic];
  Bytes bytes;
  dds::SampleInfo info;
  while (state_->readers.at(topic)->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
    if (info.valid_data) all.push_back(bytes);
  }
  return all;
}

int FastDdsPeer::readers(const std::string& topic) {
  dds::PublicationMatchedStatus status;
  state_->writers.at(topic)->get_publication_matched_status(status);
  return status.current_count;
}

void FastDdsPeer::publish(const std::string& topic, const Bytes& bytes) {
  Bytes copy = bytes;
  if (!state_->writers.at(topic)->write(&copy)) throw std::runtime_error("Fast DDS did not take the message");
}

std::map<std::string, Announcement> FastDdsPeer::announced() {
  const std::scoped_lock lock(state_->mutex);
  return state_->announced;
}

}  // namespace tactus::ros2::test
