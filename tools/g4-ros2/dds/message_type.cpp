// SPDX-License-Identifier: MIT
#include "message_type.hpp"

#include <messages.h>

namespace g4_tool::dds {

const message_type laser_scan{&sensor_msgs_msg_dds__LaserScan__desc,
                              "64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828"};
const message_type point_cloud2{&sensor_msgs_msg_dds__PointCloud2__desc,
                                "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"};
const message_type odometry{&nav_msgs_msg_dds__Odometry__desc,
                            "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"};
const message_type tf_message{&tf2_msgs_msg_dds__TFMessage__desc,
                              "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"};
const message_type diagnostic_array{
    &diagnostic_msgs_msg_dds__DiagnosticArray__desc,
    "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"};
const message_type clock_message{
    &rosgraph_msgs_msg_dds__Clock__desc,
    "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"};
const message_type bool_message{&std_msgs_msg_dds__Bool__desc,
                                "feb91e995ff9ebd09c0cb3d2aed18b11077585839fb5db80193b62d74528f6c9"};

}  // namespace g4_tool::dds
