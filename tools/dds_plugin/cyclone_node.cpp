// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// DdsNode by Cyclone DDS. Messages stay CDR bytes: a type of DDS here is a name alone.
#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

#include "adit/tools/dds/dds_node.hpp"

namespace adit {
namespace {

constexpr std::size_t kEncapsulation = 4;  // bytes before the content
constexpr uint32_t kMostAtOnce = 64;
constexpr std::size_t kMostPublishers = 1024;

// --- A type without structure -------------------------------------------------------------------

/// The bytes of a message, padded to 4, since DDS may read so far.
struct RawData : ddsi_serdata {
  std::vector<std::byte> bytes;
  std::size_t size = 0;

  RawData(const ddsi_sertype* of_type, ddsi_serdata_kind of_kind) : ddsi_serdata{} {
    ddsi_serdata_init(this, of_type, of_kind);
    hash = of_type->serdata_basehash;
  }
  void resize(std::size_t wanted) {
    size = wanted;
    bytes.resize((wanted + 3) / 4 * 4);
  }
};

const RawData& raw(const ddsi_serdata* data) {
  return *static_cast<const RawData*>(data);
}

bool equal_key(const ddsi_serdata*, const ddsi_serdata*) {
  return true;  // there are no keys
}

uint32_t size_of(const ddsi_serdata* data) {
  return static_cast<uint32_t>(raw(data).size);
}

ddsi_serdata* from_network(const ddsi_sertype* type, ddsi_serdata_kind kind,
                           const nn_rdata* fragment, std::size_t size) {
  auto data = std::make_unique<RawData>(type, kind);
  data->resize(size);
  uint32_t at = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    const auto end = static_cast<uint32_t>(std::min<std::size_t>(fragment->maxp1, size));
    if (end > at && fragment->min <= at) {
      const unsigned char* payload =
          NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
      std::memcpy(data->bytes.data() + at, payload + (at - fragment->min), end - at);
      at = end;
    }
  }
  return data.release();
}

ddsi_serdata* from_parts(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                         const ddsrt_iovec_t* parts, std::size_t size) {
  auto data = std::make_unique<RawData>(type, kind);
  data->resize(size);
  std::size_t at = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < count && at < size; ++i) {
    const std::size_t length = std::min<std::size_t>(parts[i].iov_len, size - at);
    std::memcpy(data->bytes.data() + at, parts[i].iov_base, length);
    at += length;
  }
  return data.release();
}

ddsi_serdata* from_keyhash(const ddsi_sertype* type, const ddsi_keyhash*) {
  return new RawData(type, SDK_KEY);
}

ddsi_serdata* from_sample(const ddsi_sertype*, ddsi_serdata_kind, const void*) {
  return nullptr;  // messages are written as they are
}

void to_network(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* buffer) {
  std::memcpy(buffer, raw(data).bytes.data() + offset, size);
}

ddsi_serdata* to_network_reference(const ddsi_serdata* data, std::size_t offset, std::size_t size,
                                   ddsrt_iovec_t* reference) {
  reference->iov_base = const_cast<std::byte*>(raw(data).bytes.data() + offset);
  reference->iov_len = size;
  return ddsi_serdata_ref(data);
}

void end_reference(ddsi_serdata* data, const ddsrt_iovec_t*) {
  ddsi_serdata_unref(data);
}

bool to_sample(const ddsi_serdata*, void*, void**, void*) {
  return false;
}

ddsi_serdata* to_untyped(const ddsi_serdata* data) {
  auto* untyped = new RawData(data->type, SDK_KEY);
  untyped->type = nullptr;
  return untyped;
}

bool untyped_to_sample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
  return true;
}

void free_data(ddsi_serdata* data) {
  delete static_cast<RawData*>(data);
}

std::size_t print(const ddsi_sertype*, const ddsi_serdata*, char* buffer, std::size_t) {
  *buffer = '\0';
  return 0;
}

void keyhash_of(const ddsi_serdata*, ddsi_keyhash* hash, bool) {
  std::memset(hash, 0, sizeof(*hash));
}

#ifdef DDS_HAS_SHM
uint32_t shared_size(const ddsi_serdata* data) {
  return size_of(data);
}

ddsi_serdata* from_shared(const ddsi_sertype*, ddsi_serdata_kind, void*, void*) {
  return nullptr;  // not used: no type here is of a fixed size
}
#endif

ddsi_serdata_ops data_operations() {
  ddsi_serdata_ops operations{};
  operations.eqkey = equal_key;
  operations.get_size = size_of;
  operations.from_ser = from_network;
  operations.from_ser_iov = from_parts;
  operations.from_keyhash = from_keyhash;
  operations.from_sample = from_sample;
  operations.to_ser = to_network;
  operations.to_ser_ref = to_network_reference;
  operations.to_ser_unref = end_reference;
  operations.to_sample = to_sample;
  operations.to_untyped = to_untyped;
  operations.untyped_to_sample = untyped_to_sample;
  operations.free = free_data;
  operations.print = print;
  operations.get_keyhash = keyhash_of;
#ifdef DDS_HAS_SHM
  operations.get_sample_size = shared_size;
  operations.from_iox_buffer = from_shared;
#endif
  return operations;
}

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete type;
}

ddsi_sertype_ops type_operations() {
  ddsi_sertype_ops operations{};
  operations.version = ddsi_sertype_v0;
  operations.free = free_type;
  operations.zero_samples = [](const ddsi_sertype*, void*, std::size_t) {};
  operations.realloc_samples = [](void** pointers, const ddsi_sertype*, void*, std::size_t,
                                  std::size_t count) {
    std::fill(pointers, pointers + count, nullptr);
  };
  operations.free_samples = [](const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {};
  operations.equal = [](const ddsi_sertype*, const ddsi_sertype*) { return true; };
  operations.hash = [](const ddsi_sertype*) { return uint32_t{0}; };
  return operations;
}

ddsi_sertype* make_type(const std::string& name) {
  static const ddsi_serdata_ops data = data_operations();
  static const ddsi_sertype_ops type = type_operations();
  auto* made = new ddsi_sertype{};
  ddsi_sertype_init(made, name.c_str(), &type, &data, true);
  made->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return made;
}

// --- Names --------------------------------------------------------------------------------------

constexpr std::string_view kTopicPrefix = "rt/";
constexpr std::string_view kTypeInfix = "::dds_::";

std::string wire_topic(const std::string& name) {
  return std::string(kTopicPrefix) + (name.starts_with('/') ? name.substr(1) : name);
}

/// "sensor_msgs/PointCloud2" to "sensor_msgs::msg::dds_::PointCloud2_".
std::string wire_type(const std::string& type) {
  const std::size_t slash = type.find('/');
  return type.substr(0, slash) + "::msg::dds_::" + type.substr(slash + 1) + "_";
}

/// A topic of messages by its names on the wire; nothing for services and what is none of ROS's.
std::optional<DdsTopic> ros_topic(std::string_view topic, std::string_view type) {
  const std::size_t infix = type.find(kTypeInfix);
  const std::size_t package = type.find("::");
  if (!topic.starts_with(kTopicPrefix) || infix == std::string_view::npos || !type.ends_with('_')) {
    return std::nullopt;
  }
  std::string_view name = type.substr(infix + kTypeInfix.size());
  name.remove_suffix(1);
  return DdsTopic{.name = "/" + std::string(topic.substr(kTopicPrefix.size())),
                  .type = std::string(type.substr(0, package)) + "/" + std::string(name)};
}

// --- The node -----------------------------------------------------------------------------------

[[noreturn]] void fail(const std::string& attempt, dds_return_t result) {
  throw std::runtime_error(attempt + ": " + dds_strretcode(-result));
}

dds_entity_t required(const std::string& attempt, dds_entity_t entity) {
  if (entity < 0) {
    fail(attempt, entity);
  }
  return entity;
}

struct QosDelete {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDelete>;

/// `depth`: the last messages that are kept for the other side; 0: all, until they are taken.
Qos qos_of(const DdsTopic& topic, int32_t depth) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(),
                       topic.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       DDS_MSECS(100));
  dds_qset_durability(qos.get(),
                      topic.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), depth > 0 ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL, depth);
  const dds_data_representation_id_t representation = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &representation);
  return qos;
}

/// Where this machine alone is wanted, its nodes are asked one by one and nothing is sent to all:
/// loopback as the only interface would hide nodes that name another address of the machine.
std::string configuration(const DdsOptions& options) {
  const std::string general = options.this_machine ? "<AllowMulticast>false</AllowMulticast>" : "";
  const std::string peers =
      options.this_machine ? "<Peers><Peer address=\"127.0.0.1\"/></Peers>" : "";
  return "<CycloneDDS><Domain id=\"any\"><General>" + general +
         "</General><Discovery><SPDPInterval>500ms</SPDPInterval>"
         "<ParticipantIndex>auto</ParticipantIndex>"
         "<MaxAutoParticipantIndex>120</MaxAutoParticipantIndex>" +
         peers + "</Discovery><Internal><SocketReceiveBufferSize min=\"default\" max=\"" +
         std::to_string(options.receive_buffer) + "B\"/></Internal></Domain></CycloneDDS>";
}

class CycloneNode final : public DdsNode {
 public:
  explicit CycloneNode(const DdsOptions& options) {
    const dds_entity_t domain = dds_create_domain(options.domain, configuration(options).c_str());
    if (domain < 0 && domain != DDS_RETCODE_PRECONDITION_NOT_MET) {  // it is there already
      fail("domain " + std::to_string(options.domain), domain);
    }
    domain_ = domain < 0 ? 0 : domain;
    participant_ =
        required("participant", dds_create_participant(options.domain, nullptr, nullptr));
    publications_ = required(
        "discovery",
        dds_create_reader(participant_, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr));
    waitset_ = required("waitset", dds_create_waitset(participant_));
  }

  ~CycloneNode() override { dds_delete(domain_ > 0 ? domain_ : participant_); }

  std::vector<DdsTopic> published() override {
    std::vector<void*> samples(kMostPublishers, nullptr);
    std::vector<dds_sample_info_t> infos(kMostPublishers);
    const dds_return_t count =
        dds_read(publications_, samples.data(), infos.data(), kMostPublishers, kMostPublishers);
    dds_instance_handle_t self = 0;
    dds_get_instance_handle(participant_, &self);
    std::vector<DdsTopic> topics;
    for (dds_return_t i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const auto* one = static_cast<const dds_builtintopic_endpoint_t*>(samples[k]);
      if (!infos[k].valid_data || infos[k].instance_state != DDS_IST_ALIVE ||
          one->participant_instance_handle == self) {
        continue;
      }
      if (std::optional<DdsTopic> topic = ros_topic(one->topic_name, one->type_name)) {
        dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
        dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
        dds_duration_t longest = 0;
        dds_qget_reliability(one->qos, &reliability, &longest);
        dds_qget_durability(one->qos, &durability);
        topic->reliable = reliability == DDS_RELIABILITY_RELIABLE;
        topic->latched = durability != DDS_DURABILITY_VOLATILE;
        topics.push_back(std::move(*topic));
      }
    }
    if (count > 0) {
      dds_return_loan(publications_, samples.data(), count);
    }
    return topics;
  }

  std::size_t subscribe(const DdsTopic& topic) override {
    const dds_entity_t reader = required(
        "subscription to " + topic.name,
        dds_create_reader(participant_, topic_of(topic).entity, qos_of(topic, 0).get(), nullptr));
    const dds_entity_t arrival =
        required("subscription to " + topic.name, dds_create_readcondition(reader, DDS_ANY_STATE));
    dds_waitset_attach(waitset_, arrival, arrival);
    readers_.push_back(reader);
    return readers_.size() - 1;
  }

  std::optional<DdsMessage> take(std::chrono::milliseconds longest_wait) override {
    if (ready_.empty()) {
      take_all();
    }
    if (ready_.empty() && longest_wait.count() > 0) {
      dds_waitset_wait(waitset_, nullptr, 0, DDS_MSECS(longest_wait.count()));
      take_all();
    }
    if (ready_.empty()) {
      return std::nullopt;
    }
    DdsMessage first = std::move(ready_.front());
    ready_.pop_front();
    return first;
  }

  DdsFaults faults(std::size_t topic) override {
    dds_sample_lost_status_t lost{};
    dds_requested_incompatible_qos_status_t incompatible{};
    dds_get_sample_lost_status(readers_.at(topic), &lost);
    dds_get_requested_incompatible_qos_status(readers_.at(topic), &incompatible);
    return {.lost = lost.total_count, .incompatible = incompatible.total_count};
  }

  std::size_t advertise(const DdsTopic& topic) override {
    constexpr int32_t kKept = 10;
    const Topic made = topic_of(topic);
    const Qos qos = qos_of(topic, topic.latched ? 1 : kKept);
    writers_.push_back(
        {.entity = required("publication of " + topic.name,
                            dds_create_writer(participant_, made.entity, qos.get(), nullptr)),
         .type = made.type});
    return writers_.size() - 1;
  }

  void publish(std::size_t topic, std::span<const std::byte> bytes) override {
    const Topic& writer = writers_.at(topic);
    auto data = std::make_unique<RawData>(writer.type, SDK_DATA);
    data->resize(bytes.size());
    std::memcpy(data->bytes.data(), bytes.data(), bytes.size());
    data->timestamp.v = dds_time();
    dds_forwardcdr(writer.entity, data.release());
  }

 private:
  /// A topic, or who writes to it. DDS keeps the type as long as the entity.
  struct Topic {
    dds_entity_t entity = 0;
    const ddsi_sertype* type = nullptr;
  };

  Topic topic_of(const DdsTopic& topic) {
    ddsi_sertype* type = make_type(wire_type(topic.type));
    const dds_entity_t made = dds_create_topic_sertype(participant_, wire_topic(topic.name).c_str(),
                                                       &type, nullptr, nullptr, nullptr);
    if (made < 0) {
      ddsi_sertype_unref(type);
      fail("topic " + topic.name, made);
    }
    return {.entity = made, .type = type};
  }

  /// In the order of arrival as far as it shows: reader by reader, by the times of sending.
  void take_all() {
    std::vector<std::pair<dds_time_t, DdsMessage>> taken;
    for (std::size_t i = 0; i < readers_.size(); ++i) {
      std::array<ddsi_serdata*, kMostAtOnce> samples{};
      std::array<dds_sample_info_t, kMostAtOnce> infos{};
      const dds_return_t count =
          dds_takecdr(readers_[i], samples.data(), kMostAtOnce, infos.data(), DDS_ANY_STATE);
      for (dds_return_t k = 0; k < count; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const RawData& data = raw(samples[at]);
        if (infos[at].valid_data && data.size >= kEncapsulation) {
          DdsMessage message{.topic = i, .received = Nanoseconds(dds_time()), .bytes = data.bytes};
          message.bytes.resize(data.size);
          taken.emplace_back(infos[at].source_timestamp, std::move(message));
        }
        ddsi_serdata_unref(samples[at]);
      }
    }
    std::ranges::stable_sort(taken, {}, [](const auto& one) { return one.first; });
    for (auto& [sent, message] : taken) {
      message.received = std::max(message.received, last_);
      last_ = message.received;
      ready_.push_back(std::move(message));
    }
  }

  dds_entity_t domain_ = 0;
  dds_entity_t participant_ = 0;
  dds_entity_t publications_ = 0;
  dds_entity_t waitset_ = 0;
  std::vector<dds_entity_t> readers_;
  std::vector<Topic> writers_;
  std::deque<DdsMessage> ready_;
  Nanoseconds last_{0};
};

}  // namespace
}  // namespace adit

extern "C" __attribute__((visibility("default"))) int adit_dds_interface() {
  return adit::kDdsInterface;
}

extern "C" __attribute__((visibility("default"))) adit::DdsNode* adit_dds_open(
    const adit::DdsOptions& options, std::string& error) {
  try {
    return new adit::CycloneNode(options);
  } catch (const std::exception& failure) {
    error = failure.what();
    return nullptr;
  }
}
