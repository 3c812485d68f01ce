// SPDX-License-Identifier: MIT
#include "cdr_message.hpp"

#include <dds/ddsi/ddsi_sertype.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "bus.hpp"
#include "entity.hpp"

namespace g4_tool::dds {

// A writer does not give its type; a message that came to a reader of this process does. So one message, all of
// zeros, goes from a writer to a reader of a topic that nobody else has.
const ddsi_sertype* type_in(dds_entity_t participant, const message_type& type) {
  const dds_topic_descriptor_t& described = *type.descriptor;
  const qos plain =
      qos_of({.type = &type, .depth = 1});  // with the hash, without which ROS 2 warns
  std::string name = std::string("g4lidar_type_") + described.m_typename;
  std::ranges::replace(name, ':', '_');
  const entity topic(dds_create_topic(participant, &described, name.c_str(), nullptr, nullptr));
  const entity reader(dds_create_reader(participant, topic.get(), plain.get(), nullptr));
  const entity writer(dds_create_writer(participant, topic.get(), plain.get(), nullptr));
  const std::vector<std::uint64_t> zeros(described.m_size / sizeof(std::uint64_t) + 1);
  ddsi_serdata* taken = nullptr;
  dds_sample_info_t about{};
  if (dds_write(writer.get(), zeros.data()) != DDS_RETCODE_OK) return nullptr;
  if (dds_takecdr(reader.get(), &taken, 1, &about, DDS_ANY_STATE) != 1) return nullptr;
  return cdr_message(taken)->type;
}

cdr_message encoded(const ddsi_sertype& type, g4lidar::bytes message) {
  ddsrt_iovec_t all{};
  all.iov_base = const_cast<std::uint8_t*>(message.data());  // it is only read
  all.iov_len = static_cast<ddsrt_iov_len_t>(message.size());
  return cdr_message(ddsi_serdata_from_ser_iov(&type, SDK_DATA, 1, &all, message.size()));
}

dds_return_t write_cdr(dds_entity_t writer, const cdr_message& message) {
  return dds_writecdr(writer, ddsi_serdata_ref(message.get()));  // which releases it in every case
}

bool is_kept(const cdr_message& message) noexcept { return ddsrt_atomic_ld32(&message->refc) > 1; }

}  // namespace g4_tool::dds
