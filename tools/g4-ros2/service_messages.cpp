// SPDX-License-Identifier: MIT
#include "service_messages.hpp"

#include <algorithm>

namespace g4_tool {

// The hashes are those of the services, with the definitions that they have since Iron.
const dds::service_type get_type{
    &rcl_interfaces_srv_dds__GetParameters_Request__desc,
    &rcl_interfaces_srv_dds__GetParameters_Response__desc,
    "bf9803d5c74cf989a5de3e0c2e99444599a627c7ff75f97b8c05b01003675cbc"};
const dds::service_type get_types_type{
    &rcl_interfaces_srv_dds__GetParameterTypes_Request__desc,
    &rcl_interfaces_srv_dds__GetParameterTypes_Response__desc,
    "da199c878688b3e530bdfe3ca8f74cb9fa0c303101e980a9e8f260e25e1c80ca"};
const dds::service_type set_type{
    &rcl_interfaces_srv_dds__SetParameters_Request__desc,
    &rcl_interfaces_srv_dds__SetParameters_Response__desc,
    "56eed9a67e169f9cb6c1f987bc88f868c14a8fc9f743a263bc734c154015d7e0"};
const dds::service_type set_atomically_type{
    &rcl_interfaces_srv_dds__SetParametersAtomically_Request__desc,
    &rcl_interfaces_srv_dds__SetParametersAtomically_Response__desc,
    "0e192ef259c07fc3c07a13191d27002222e65e00ccec653ca05e856f79285fcd"};
const dds::service_type list_type{
    &rcl_interfaces_srv_dds__ListParameters_Request__desc,
    &rcl_interfaces_srv_dds__ListParameters_Response__desc,
    "3e6062bfbb27bfb8730d4cef2558221f51a11646d78e7bb30a1e83afac3aad9d"};
const dds::service_type describe_type{
    &rcl_interfaces_srv_dds__DescribeParameters_Request__desc,
    &rcl_interfaces_srv_dds__DescribeParameters_Response__desc,
    "845b484d71eb0673dae682f2e3ba3c4851a65a3dcfb97bddd82c5b57e91e4cff"};
const dds::service_type trigger_type{
    &std_srvs_srv_dds__Trigger_Request__desc, &std_srvs_srv_dds__Trigger_Response__desc,
    "eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f"};

g4lidar::parameter_value value_of(const rcl_interfaces_msg_dds__ParameterValue_& from) {
  switch (from.type) {
    case 1:
      return from.bool_value;
    case 2:
      return from.integer_value;
    case 3:
      return from.double_value;
    case 4:
      return std::string(from.string_value);
    default:
      return {};
  }
}

bool is_below(std::string_view name, std::string_view prefix, std::uint64_t depth) {
  if (name == prefix) return true;
  if (!prefix.empty()) {
    if (!name.starts_with(prefix) || name[prefix.size()] != '.') return false;
    name.remove_prefix(prefix.size() + 1);
  }
  return depth == 0 || static_cast<std::uint64_t>(std::ranges::count(name, '.')) < depth;
}

}  // namespace g4_tool
