// SPDX-License-Identifier: MIT
// For scripts/ci/ros2: the crate ros2-client lists the node /g4lidar by its announcement; with the feature humble by that
// of Humble.
use futures::{FutureExt, StreamExt};
use ros2_client::{Context, ContextOptions, NodeEvent, NodeName, NodeOptions};

fn main() {
    let domain = std::env::var("ROS_DOMAIN_ID").unwrap().parse().unwrap();
    let context = Context::with_options(ContextOptions::new().domain_id(domain)).unwrap();
    let mut node = context
        .new_node(NodeName::new("/", "finder").unwrap(), NodeOptions::new())
        .unwrap();
    let spinner = node.spinner().unwrap();
    let mut events = Box::pin(node.status_receiver());
    let search = async {
        loop {
            let NodeEvent::ROS(info) = events.next().await.unwrap() else { continue };
            if info.nodes().iter().any(|each| each.fully_qualified_name() == "/g4lidar") {
                return true;
            }
        }
    };
    let spin = async { spinner.spin().await.unwrap() };
    let is_listed = smol::block_on(async {
        futures::select! {
            () = spin.fuse() => false,
            is_listed = Box::pin(search).fuse() => is_listed,
        }
    });
    assert!(is_listed);
    println!("RustDDS: the node /g4lidar");
}
