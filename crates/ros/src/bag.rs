//! A bag of ROS 2: a folder with an MCAP file and `metadata.yaml`, as rosbag2 writes it (its version 5: Humble and
//! newer read it).

use crate::convert::TopicMessage;
use crate::topics::{Quality, Topic};
use rumbo_log::Container;
use serde_json::json;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// A quality of service as rosbag2 notes it.
fn quality(quality: Quality) -> String {
    let reliability = if quality.reliable { 1 } else { 2 };
    let durability = if quality.latched { 1 } else { 2 };
    let forever = json!({ "sec": 9_223_372_036_u64, "nsec": 854_775_807_u64 });
    json!([{
        "history": 1,
        "depth": quality.depth,
        "reliability": reliability,
        "durability": durability,
        "deadline": forever,
        "lifespan": forever,
        "liveliness": 1,
        "liveliness_lease_duration": forever,
        "avoid_ros_namespace_conventions": false,
    }])
    .to_string()
}

/// Writes the MCAP file. `library` says who wrote it.
///
/// # Errors
/// What `into` does not take.
pub fn write<W: Write>(into: W, messages: &[TopicMessage], library: &str) -> io::Result<W> {
    let mut bag = Container::new(into, "ros2", library)?;
    let mut channels = BTreeMap::new();
    for topic in topics(messages).into_keys() {
        let definition = topic.definition();
        let schema = bag.schema(definition.name, "ros2msg", definition.text().as_bytes());
        let about = [
            ("offered_qos_profiles", quality(topic.quality())),
            ("topic_type_hash", definition.hash()),
        ];
        let about = about.map(|(key, value)| (key.to_owned(), value));
        let channel = bag.channel(schema, topic.name(), "cdr", &BTreeMap::from(about));
        channels.insert(topic, (channel, 0));
    }
    for message in messages {
        if let Some((channel, sequence)) = channels.get_mut(&message.topic) {
            bag.message(*channel, *sequence, message.t_ns, &message.data)?;
            *sequence += 1;
        }
    }
    bag.finish()
}

/// The text of `metadata.yaml`, for an MCAP file of this name. It is JSON, which is YAML too.
#[must_use]
pub fn metadata(messages: &[TopicMessage], file: &str) -> String {
    let (first, last) = (
        messages.first().map_or(0, |message| message.t_ns),
        messages.last().map_or(0, |message| message.t_ns),
    );
    let duration = json!({ "nanoseconds": last - first });
    let start = json!({ "nanoseconds_since_epoch": first });
    let topics = topics(messages).into_iter().map(|(topic, count)| {
        json!({
            "topic_metadata": {
                "name": topic.name(),
                "type": topic.definition().name,
                "type_description_hash": topic.definition().hash(),
                "serialization_format": "cdr",
                "offered_qos_profiles": quality(topic.quality()),
            },
            "message_count": count,
        })
    });
    let metadata = json!({
        "rosbag2_bagfile_information": {
            "version": 5,
            "storage_identifier": "mcap",
            "duration": duration,
            "starting_time": start,
            "message_count": messages.len(),
            "topics_with_message_count": topics.collect::<Vec<_>>(),
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [file],
            "files": [{
                "path": file,
                "starting_time": start,
                "duration": duration,
                "message_count": messages.len(),
            }],
        }
    });
    format!("{metadata:#}\n")
}

/// The topics that have messages, and how many.
fn topics(messages: &[TopicMessage]) -> BTreeMap<Topic, usize> {
    let mut topics = BTreeMap::new();
    for message in messages {
        *topics.entry(message.topic).or_default() += 1;
    }
    topics
}
