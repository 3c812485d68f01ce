// SPDX-License-Identifier: MIT
// A client as rmw_cyclonedds is one calls the services; expected values are the settings of the simulated device.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <services.h>
#include "cli/program.hpp"
#include "lidar.hpp"
#include "subscriber.hpp"

namespace ros2 {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using value = rcl_interfaces_msg_dds__ParameterValue_;

value number(double of) {
  value made{};
  made.type = 3;
  made.double_value = of;
  return made;
}
value whole(std::int64_t of) {
  value made{};
  made.type = 2;
  made.integer_value = of;
  return made;
}
value text(const char* of) {
  value made{};
  made.type = 4;
  made.string_value = const_cast<char*>(of);
  return made;
}

std::string user_data_of(const dds_builtintopic_endpoint_t& of) {
  void* data = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(of.qos, &data, &size)) return {};
  std::string made(static_cast<const char*>(data), size);
  dds_free(data);
  return made;
}

/// Its writer and its reader have the same clientid, as in rmw_cyclonedds.
template <class Request, class Reply>
class client {
 public:
  client(const test_domain& in, const std::string& service, const dds_topic_descriptor_t& request,
         const dds_topic_descriptor_t& reply) {
    const dds::message_type type{&request, ""};
    const dds::qos quality = dds::qos_of({.type = &type, .depth = 10});
    const std::string id = "clientid=01.02." + std::to_string(++made_) + ";";
    dds_qset_userdata(quality.get(), id.data(), id.size());
    request_topic_ = dds::entity(dds_create_topic(
        in.participant(), &request, ("rq/" + service + "Request").c_str(), nullptr, nullptr));
    reply_topic_ = dds::entity(dds_create_topic(
        in.participant(), &reply, ("rr/" + service + "Reply").c_str(), nullptr, nullptr));
    writer_ = dds::entity(
        dds_create_writer(in.participant(), request_topic_.get(), quality.get(), nullptr));
    reader_ = dds::entity(
        dds_create_reader(in.participant(), reply_topic_.get(), quality.get(), nullptr));
    EXPECT_TRUE(writer_ && reader_) << service;
  }

  /// As rmw_cyclonedds finds a service: a reader of requests and a writer of replies with the same serviceid.
  [[nodiscard]] bool is_there() const {
    dds_instance_handle_t reader = 0;
    dds_instance_handle_t writer = 0;
    if (dds_get_matched_subscriptions(writer_.get(), &reader, 1) != 1) return false;
    if (dds_get_matched_publications(reader_.get(), &writer, 1) != 1) return false;
    auto* const one = dds_get_matched_subscription_data(writer_.get(), reader);
    auto* const other = dds_get_matched_publication_data(reader_.get(), writer);
    const bool is_pair = one != nullptr && other != nullptr &&
                         user_data_of(*one).starts_with("serviceid=") &&
                         user_data_of(*one) == user_data_of(*other);
    if (one != nullptr) dds_builtintopic_free_endpoint(one);
    if (other != nullptr) dds_builtintopic_free_endpoint(other);
    return is_pair;
  }
  void write(Request& request) {
    request.client = 0xFEDCBA9876543210;
    request.number = ++number_;
    EXPECT_EQ(dds_write(writer_.get(), &request), DDS_RETCODE_OK);
  }
  /// Writes it, and calls `use` with the reply.
  template <class Use>
  void call(Request request, Use use) {
    ASSERT_TRUE(comes_true([&] { return is_there(); }));
    write(request);
    ASSERT_TRUE(comes_true([&] { return take(use); }));
  }
  /// Calls `use` with the reply to the last request, if it is there.
  template <class Use>
  bool take(Use use) {
    void* sample = nullptr;
    dds_sample_info_t about{};
    bool is_ours = false;
    while (dds_take(reader_.get(), &sample, &about, 1, 1) > 0) {
      const auto& reply = *static_cast<const Reply*>(sample);
      if (about.valid_data && reply.client == 0xFEDCBA9876543210 && reply.number == number_) {
        is_ours = true;
        use(reply);
      }
      static_cast<void>(dds_return_loan(reader_.get(), &sample, 1));
      sample = nullptr;
    }
    return is_ours;
  }

 private:
  static inline int made_ = 0;
  std::int64_t number_ = 0;
  dds::entity request_topic_;
  dds::entity reply_topic_;
  dds::entity writer_;
  dds::entity reader_;
};

#define G4_CLIENT(name, package, service)                                \
  struct name : client<package##_srv_dds__##service##_Request_,          \
                       package##_srv_dds__##service##_Response_> {       \
    name(const test_domain& in, const std::string& path)                 \
        : client(in, path, package##_srv_dds__##service##_Request__desc, \
                 package##_srv_dds__##service##_Response__desc) {}       \
  }
G4_CLIENT(get_client, rcl_interfaces, GetParameters);
G4_CLIENT(types_client, rcl_interfaces, GetParameterTypes);
G4_CLIENT(set_client, rcl_interfaces, SetParameters);
G4_CLIENT(atomic_client, rcl_interfaces, SetParametersAtomically);
G4_CLIENT(list_client, rcl_interfaces, ListParameters);
G4_CLIENT(describe_client, rcl_interfaces, DescribeParameters);
G4_CLIENT(trigger_client, std_srvs, Trigger);

template <class Sequence>
Sequence sequence_of(auto& items) {
  return {static_cast<std::uint32_t>(items.size()), static_cast<std::uint32_t>(items.size()),
          items.data(), false};
}

class Services : public cli::scratch {
 protected:
  /// Empty where it was set, else why not.
  static std::vector<std::string> set(set_client& by,
                                      std::vector<rcl_interfaces_msg_dds__Parameter_> what) {
    std::vector<std::string> reasons;
    by.call({0, 0, sequence_of<dds_sequence_rcl_interfaces_msg_dds__Parameter_>(what)},
            [&](const auto& reply) {
              for (std::uint32_t i = 0; i < reply.results._length; ++i) {
                reasons.emplace_back(reply.results._buffer[i].reason);
                EXPECT_EQ(reply.results._buffer[i].successful, reasons.back().empty());
              }
            });
    return reasons;
  }
  /// Type and contents: "3 7", "4 cw".
  static std::vector<std::string> get(get_client& by, std::vector<const char*> names) {
    std::vector<std::string> values;
    dds_sequence_string wanted{static_cast<std::uint32_t>(names.size()),
                               static_cast<std::uint32_t>(names.size()),
                               const_cast<char**>(names.data()), false};
    by.call({0, 0, wanted}, [&](const auto& reply) {
      for (std::uint32_t i = 0; i < reply.values._length; ++i) {
        const value& one = reply.values._buffer[i];
        std::string words = std::to_string(one.type);
        if (one.type == 1) words += one.bool_value ? " true" : " false";
        if (one.type == 2) words += ' ' + std::to_string(one.integer_value);
        if (one.type == 3) words += ' ' + std::to_string(one.double_value).substr(0, 4);
        if (one.type == 4) words += ' ' + std::string(one.string_value);
        values.push_back(words);
      }
    });
    return values;
  }
  test_domain domain_;
};

rcl_interfaces_msg_dds__Parameter_ named(const char* name, const value& of) {
  return {const_cast<char*>(name), of};
}

TEST_F(Services, ParametersAreThoseOfTheDevice) {
  const served_lidar lidar;
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  cli::program tool({lidar.path(), "--fov", "-90:90"});
  ASSERT_TRUE(comes_true([&] { return scans.take() > 0; }));
  get_client getter(domain_, "g4lidar/get_parameters");
  set_client setter(domain_, "g4lidar/set_parameters");
  EXPECT_THAT(
      get(getter, {"frequency", "sample_rate", "direction", "constant", "fov", "range_max", "grid",
                   "frame_id", "nothing"}),
      ElementsAre("3 7.00", "2 9000", "4 cw", "0", "4 -90:90", "3 100.", "2 720", "4 laser", "0"));

  EXPECT_THAT(set(setter, {named("frequency", number(9.5)), named("sample_rate", whole(8000))}),
              ElementsAre("", ""));
  EXPECT_EQ(lidar.settings().scan_frequency_chz, 950);
  EXPECT_THAT(get(getter, {"frequency", "sample_rate"}), ElementsAre("3 9.50", "2 8000"));
  EXPECT_TRUE(comes_true([&] { return scans.take() > 0; })) << "the scan goes on";

  // Refused, and nothing changes; a whole number is a double, too.
  EXPECT_THAT(
      set(setter, {named("frequency", number(20)), named("frequency", text("fast")),
                   named("grid", whole(100)), named("nothing", whole(1)),
                   named("sample_rate", whole(8001)), named("frequency", whole(6))}),
      ElementsAre("frequency: '20' is not in the range 5 to 12 Hz of a G4", HasSubstr("a double"),
                  HasSubstr("cannot change"), HasSubstr("no such parameter"),
                  HasSubstr("'8001' is not one of 4k, 8k, 9k"), ""));
  EXPECT_EQ(lidar.settings().scan_frequency_chz, 600);
  tool.send(SIGINT);
  EXPECT_EQ(tool.wait().code, 130);
}

TEST_F(Services, FiltersChangeWhileItRuns) {
  const served_lidar lidar;
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  cli::program tool({lidar.path()});
  ASSERT_TRUE(comes_true([&] { return scans.take() > 0; }));
  set_client setter(domain_, "g4lidar/set_parameters");
  const auto longest = [&] {
    float most = 0.0F;
    const std::size_t count = scans.take([&](const scan_message& message) {
      for (const float range : std::span(message.ranges._buffer, message.ranges._length)) {
        if (std::isfinite(range)) most = std::max(most, range);
      }
    });
    return count == 0 ? 100.0F : most;
  };
  EXPECT_GT(longest(), 1.5F);
  EXPECT_THAT(set(setter, {named("range_max", number(1.5)), named("range_min", number(2))}),
              ElementsAre("", HasSubstr("ends before it begins")));
  EXPECT_TRUE(comes_true([&] { return longest() <= 1.5F; }));
  atomic_client atomic(domain_, "g4lidar/set_parameters_atomically");
  std::vector both{named("range_max", number(40)), named("fov", text("east"))};
  atomic.call({0, 0, sequence_of<dds_sequence_rcl_interfaces_msg_dds__Parameter_>(both)},
              [](const auto& reply) {
                EXPECT_FALSE(reply.result.successful);
                EXPECT_THAT(reply.result.reason, HasSubstr("east"));
              });
  get_client getter(domain_, "g4lidar/get_parameters");
  EXPECT_THAT(get(getter, {"range_min", "range_max", "fov"}),
              ElementsAre("3 0.00", "3 1.50", "4 -180:180"));
  tool.send(SIGINT);
}

TEST_F(Services, SeveralLidarsHaveTheirNamesBeforeADot) {
  const served_lidar front;
  const served_lidar rear;
  cli::program tool({"front=" + front.path(), "rear=" + rear.path(), "--namespace", "robot1"});
  list_client lister(domain_, "robot1/g4lidar/list_parameters");
  std::vector<std::string> names;
  std::vector<std::string> prefixes;
  char prefix[] = "rear";
  std::vector<char*> asked{prefix};
  lister.call({0, 0, sequence_of<dds_sequence_string>(asked), 1}, [&](const auto& reply) {
    const auto& result = reply.result;
    names.assign(result.names._buffer, result.names._buffer + result.names._length);
    prefixes.assign(result.prefixes._buffer, result.prefixes._buffer + result.prefixes._length);
  });
  EXPECT_THAT(names, AllOf(Contains("rear.frequency"), ::testing::Each(HasSubstr("rear."))));
  EXPECT_THAT(prefixes, ElementsAre("rear"));

  set_client setter(domain_, "robot1/g4lidar/set_parameters");
  ASSERT_TRUE(comes_true([&] {
    return set(setter, {named("rear.frequency", number(11))}) == std::vector<std::string>{""};
  }));
  EXPECT_EQ(rear.settings().scan_frequency_chz, 1100);
  EXPECT_EQ(front.settings().scan_frequency_chz, 700);

  describe_client describer(domain_, "robot1/g4lidar/describe_parameters");
  types_client types(domain_, "robot1/g4lidar/get_parameter_types");
  get_client getter(domain_, "robot1/g4lidar/get_parameters");
  ASSERT_TRUE(
      comes_true([&] { return get(getter, {"front.model"}) == std::vector<std::string>{"4 g4"}; }));
  char one[] = "front.frequency";
  char other[] = "front.serial_number";
  char third[] = "front.sample_rate";
  std::vector<char*> wanted{one, other, third};
  describer.call({0, 0, sequence_of<dds_sequence_string>(wanted)}, [](const auto& reply) {
    ASSERT_EQ(reply.descriptors._length, 3U);
    const auto& frequency = reply.descriptors._buffer[0];
    EXPECT_STREQ(frequency.name, "front.frequency");
    EXPECT_EQ(frequency.type, 3);
    EXPECT_THAT(frequency.description, HasSubstr("Hz"));
    EXPECT_FALSE(frequency.read_only);
    ASSERT_EQ(frequency.floating_point_range._length, 1U);
    EXPECT_EQ(frequency.floating_point_range._buffer[0].from_value, 5.0);
    EXPECT_EQ(frequency.floating_point_range._buffer[0].to_value, 12.0);
    EXPECT_STREQ(reply.descriptors._buffer[2].additional_constraints, "4000, 8000, 9000");
    EXPECT_TRUE(reply.descriptors._buffer[1].read_only);
  });
  types.call({0, 0, sequence_of<dds_sequence_string>(wanted)}, [](const auto& reply) {
    EXPECT_THAT(std::vector(reply.types._buffer, reply.types._buffer + reply.types._length),
                ElementsAre(3, 4, 2));
  });
  tool.send(SIGINT);
}

TEST_F(Services, StopRestsTheMotorUntilStart) {
  const served_lidar lidar;
  cli::program tool({lidar.path()});
  ASSERT_TRUE(comes_true([&] { return lidar.motor_turns(); }));
  trigger_client stop(domain_, "g4lidar/stop");
  trigger_client start(domain_, "g4lidar/start");
  stop.call({}, [](const auto& reply) {
    EXPECT_TRUE(reply.success);
    EXPECT_THAT(reply.message, HasSubstr("rests until start"));
  });
  EXPECT_TRUE(comes_true([&] { return !lidar.motor_turns(); }));
  start.call({}, [](const auto& reply) { EXPECT_STREQ(reply.message, "the motor turns"); });
  EXPECT_TRUE(comes_true([&] { return lidar.motor_turns(); }));
  tool.send(SIGINT);
}

TEST_F(Services, AnswerWhileTheLidarIsAway) {
  cli::program tool({path("not_there")});
  set_client setter(domain_, "g4lidar/set_parameters");
  get_client getter(domain_, "g4lidar/get_parameters");
  EXPECT_THAT(get(getter, {"frequency"}), ElementsAre("0"));
  EXPECT_THAT(set(setter, {named("frequency", number(8)), named("range_max", number(8))}),
              ElementsAre("the lidar is not connected", ""));
  EXPECT_THAT(set(setter, {}), IsEmpty());
  // Too many names: no answer, and the next request has one.
  const char* const name = "fov";
  std::vector<char*> many(1001, const_cast<char*>(name));
  rcl_interfaces_srv_dds__GetParameters_Request_ hostile{0, 0,
                                                         sequence_of<dds_sequence_string>(many)};
  getter.write(hostile);
  std::this_thread::sleep_for(500ms);
  EXPECT_FALSE(getter.take([](const auto&) {}));
  EXPECT_THAT(get(getter, {"range_max"}), ElementsAre("3 8.00"));
  tool.send(SIGINT);
}

}  // namespace
}  // namespace ros2
