// SPDX-License-Identifier: MIT
// For scripts/ci/ros2: prints the scans and clouds that RustDDS receives, one in each line.
use futures::StreamExt;
use ros2_client::ros2::{policy, Duration, QosPolicyBuilder};
use ros2_client::{Context, ContextOptions, MessageTypeName, Name, NodeName, NodeOptions};
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
struct Time {
    sec: i32,
    nanosec: u32,
}

#[derive(Serialize, Deserialize)]
struct Header {
    stamp: Time,
    frame_id: String,
}

#[derive(Serialize, Deserialize)]
struct LaserScan {
    header: Header,
    angle_min: f32,
    angle_max: f32,
    angle_increment: f32,
    time_increment: f32,
    scan_time: f32,
    range_min: f32,
    range_max: f32,
    ranges: Vec<f32>,
    intensities: Vec<f32>,
}

#[derive(Serialize, Deserialize)]
struct PointField {
    name: String,
    offset: u32,
    datatype: u8,
    count: u32,
}

#[derive(Serialize, Deserialize)]
struct PointCloud2 {
    header: Header,
    height: u32,
    width: u32,
    fields: Vec<PointField>,
    is_bigendian: bool,
    point_step: u32,
    row_step: u32,
    data: Vec<u8>,
    is_dense: bool,
}

fn main() {
    let domain = std::env::var("ROS_DOMAIN_ID").unwrap().parse().unwrap();
    let context = Context::with_options(ContextOptions::new().domain_id(domain)).unwrap();
    let mut node = context
        .new_node(NodeName::new("/", "reader").unwrap(), NodeOptions::new())
        .unwrap();
    let qos = QosPolicyBuilder::new()
        .history(policy::History::KeepLast { depth: 50 })
        .reliability(policy::Reliability::Reliable {
            max_blocking_time: Duration::from_millis(100),
        })
        .build();
    let topic = |name: &str, kind: &str| {
        node.create_topic(
            &Name::new("/", name).unwrap(),
            MessageTypeName::new("sensor_msgs", kind),
            &qos,
        )
        .unwrap()
    };
    let scan_topic = topic("scan", "LaserScan");
    let cloud_topic = topic("points", "PointCloud2");
    let scans = node
        .create_subscription::<LaserScan>(&scan_topic, Some(qos.clone()))
        .unwrap();
    let clouds = node
        .create_subscription::<PointCloud2>(&cloud_topic, Some(qos.clone()))
        .unwrap();
    let print_scans = scans.async_stream().for_each(|got| async {
        let Ok((scan, _)) = got else { return };
        let ranges: Vec<String> = scan.ranges.iter().map(|r| r.to_string()).collect();
        let stamp = &scan.header.stamp;
        println!("scan {} {} {} {}", stamp.sec, stamp.nanosec, scan.header.frame_id, ranges.join(" "));
    });
    let print_clouds = clouds.async_stream().for_each(|got| async {
        let Ok((cloud, _)) = got else { return };
        let fields: Vec<String> = cloud.fields.iter().map(|f| f.name.clone()).collect();
        let bytes: Vec<String> = cloud.data.iter().map(|b| format!("{b:02x}")).collect();
        let stamp = &cloud.header.stamp;
        println!(
            "cloud {} {} {} {} {} {}",
            stamp.sec, stamp.nanosec, cloud.width, cloud.row_step, fields.join(","), bytes.concat()
        );
    });
    smol::block_on(futures::future::join(print_scans, print_clouds));
}
