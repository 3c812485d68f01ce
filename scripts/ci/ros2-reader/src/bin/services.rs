// SPDX-License-Identifier: MIT
// For scripts/ci/ros2: RustDDS calls the services of a g4-ros2 with a simulated lidar. ServiceMapping::Cyclone of the
// crate ros2-client 0.8.2 cannot read replies (it decodes the header as the reply), so the header of rmw_cyclonedds is
// part of the messages here, on topics of RustDDS; the messages are those of the crate.
use ros2_client::parameters::raw;
use ros2_client::rcl_interfaces::*;
use ros2_client::rustdds::{policy, DomainParticipant, Duration, QosPolicyBuilder, TopicKind};
use ros2_client::ParameterValue;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Serialize, Deserialize)]
struct TriggerRequest {
    structure_needs_at_least_one_member: u8,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
struct TriggerResponse {
    success: bool,
    message: String,
}

/// A message as rmw_cyclonedds sends it.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Headed<T> {
    client: u64,
    number: i64,
    body: T,
}

/// The reply; asks again until the service is discovered.
fn call<Q: Serialize + Clone + std::fmt::Debug, R: DeserializeOwned + 'static>(
    domain: u16,
    (package, kind, name): (&str, &str, &str),
    body: Q,
) -> R {
    // One for each call: entities that are made after others were deleted are not announced.
    let node = DomainParticipant::new(domain).unwrap();
    let qos = QosPolicyBuilder::new()
        .history(policy::History::KeepLast { depth: 10 })
        .reliability(policy::Reliability::Reliable {
            max_blocking_time: Duration::from_millis(100),
        })
        .build();
    let topic = |path: String, kind: String| node.create_topic(path, kind, &qos, TopicKind::NoKey).unwrap();
    let prefix = format!("{package}::srv::dds_::{kind}");
    let requests = topic(format!("rq/g4lidar/{name}Request"), format!("{prefix}_Request_"));
    let replies = topic(format!("rr/g4lidar/{name}Reply"), format!("{prefix}_Response_"));
    let mut reader = node
        .create_subscriber(&qos)
        .unwrap()
        .create_datareader_no_key_cdr::<Headed<R>>(&replies, None)
        .unwrap();
    let writer = node
        .create_publisher(&qos)
        .unwrap()
        .create_datawriter_no_key_cdr::<Headed<Q>>(&requests, None)
        .unwrap();
    for number in 1..20 {
        let client = 0x0123456789abcdef;
        writer.write(Headed { client, number, body: body.clone() }, None).unwrap();
        for _ in 0..200 {
            std::thread::sleep(std::time::Duration::from_millis(10));
            if let Some(reply) = reader.take_next_sample().unwrap() {
                let reply = reply.into_value();
                assert_eq!((reply.client, reply.number), (client, number));
                return reply.body;
            }
        }
    }
    panic!("{name}: no reply");
}

fn parameters<Q: Serialize + Clone + std::fmt::Debug, R: DeserializeOwned + 'static>(
    domain: u16,
    kind: &str,
    name: &str,
    body: Q,
) -> R {
    call(domain, ("rcl_interfaces", kind, name), body)
}

fn get(domain: u16, name: &str) -> raw::ParameterValue {
    let request = GetParametersRequest { names: vec![name.to_string()] };
    let reply: GetParametersResponse = parameters(domain, "GetParameters", "get_parameters", request);
    reply.values[0].clone()
}

fn set(domain: u16, name: &str, value: ParameterValue) -> raw::SetParametersResult {
    let parameter = raw::Parameter { name: name.to_string(), value: value.into() };
    let request = SetParametersRequest { parameter: vec![parameter] };
    let reply: SetParametersResponse = parameters(domain, "SetParameters", "set_parameters", request);
    reply.results[0].clone()
}

fn trigger(domain: u16, name: &str) -> TriggerResponse {
    let request = TriggerRequest { structure_needs_at_least_one_member: 0 };
    call(domain, ("std_srvs", "Trigger", name), request)
}

fn main() {
    let domain = std::env::var("ROS_DOMAIN_ID").unwrap().parse().unwrap();

    let request = ListParametersRequest { prefixes: vec![], depth: 0 };
    let list: ListParametersResponse = parameters(domain, "ListParameters", "list_parameters", request);
    assert!(list.result.names.contains(&"frequency".to_string()), "{list:?}");

    assert_eq!(get(domain, "frequency").double_value, 7.0);
    let done = set(domain, "frequency", ParameterValue::Double(9.5));
    assert!(done.successful, "{done:?}");
    let refused = set(domain, "frequency", ParameterValue::Double(20.0));
    assert!(!refused.successful && refused.reason.contains("5 to 12"), "{refused:?}");
    assert_eq!(get(domain, "frequency").double_value, 9.5);

    let request = DescribeParametersRequest { names: vec!["grid".to_string()] };
    let grid: DescribeParametersResponse = parameters(domain, "DescribeParameters", "describe_parameters", request);
    assert!(grid.values[0].read_only && grid.values[0].name == "grid", "{grid:?}");

    for name in ["stop", "start"] {
        let reply = trigger(domain, name);
        assert!(reply.success && reply.message.contains("motor"), "{reply:?}");
    }
    println!("RustDDS: 8 calls of the services of parameters, start and stop");
}
