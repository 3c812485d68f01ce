// SPDX-License-Identifier: MIT
// A message that is encoded already, for a writer of Cyclone DDS.
#pragma once

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <memory>

#include "g4lidar/core/bytes.hpp"
#include "message_type.hpp"

namespace g4_tool::dds {

struct release_message {
  void operator()(ddsi_serdata* message) const noexcept { ddsi_serdata_unref(message); }
};
/// A share of a message. To be given back before the domain is deleted.
using cdr_message = std::unique_ptr<ddsi_serdata, release_message>;

/// A type as the domain of `participant` has it, in XCDR1; null if that fails. Valid while there is a topic of
/// this type.
[[nodiscard]] const ddsi_sertype* type_in(dds_entity_t participant, const message_type& type);

/// A copy of `message`, in CDR with its header of four bytes; null if it is not valid for the type.
[[nodiscard]] cdr_message encoded(const ddsi_sertype& type, g4lidar::bytes message);

/// Writes it to a writer of its type. DDS_RETCODE_OK, or why it was not written.
[[nodiscard]] dds_return_t write_cdr(dds_entity_t writer, const cdr_message& message);

/// Whether a writer still keeps it, because not every reliable reader has acknowledged it.
[[nodiscard]] bool is_kept(const cdr_message& message) noexcept;

}  // namespace g4_tool::dds
