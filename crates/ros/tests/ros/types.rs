//! Types are those of ROS 2: hashes and bytes as `rosidl` and Fast CDR make them.

use rumbo_ros::messages::{BatteryState, Diagnostics, Event, JointState, KeyValue, Odometry};
use rumbo_ros::messages::{DiagnosticStatus, Header, Range, Text, Time, Transforms};
use rumbo_ros::messages::{LaserScan, Markers, OccupancyGrid};
use rumbo_ros::service_messages::{
    EarlierFeedbackMessage, GoalStatusArray, ParameterDescriptor, ParameterEvent,
};
use rumbo_ros::types::{Byte, Message, encode};

#[test]
fn hashes_are_those_of_the_distributions() {
    for (definition, hash) in [
        (
            Header::DEFINITION,
            "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01",
        ),
        (
            Text::DEFINITION,
            "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
        ),
        (
            Odometry::DEFINITION,
            "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
        ),
        (
            Transforms::DEFINITION,
            "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
        ),
        (
            JointState::DEFINITION,
            "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
        ),
        (
            Range::DEFINITION,
            "b42b62562e93cbfe9d42b82fe5994dfa3d63d7d5c90a317981703f7388adff3a",
        ),
        (
            BatteryState::DEFINITION,
            "4bee5dfce981c98faa6828b868307a0a73f992ed0789f374ee96c8f840e69741",
        ),
        (
            Diagnostics::DEFINITION,
            "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
        ),
        (
            Event::DEFINITION,
            "e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac",
        ),
        (
            OccupancyGrid::DEFINITION,
            "8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7",
        ),
        (
            Markers::DEFINITION,
            "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf",
        ),
        (
            LaserScan::DEFINITION,
            "64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828",
        ),
        (
            ParameterEvent::DEFINITION,
            "043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204",
        ),
        (
            ParameterDescriptor::DEFINITION,
            "52175dbfda6c51153101d33d2a9da05743f66f02d5ab2ca9ec4709b46b73d704",
        ),
        (
            EarlierFeedbackMessage::DEFINITION,
            "9d1f6fa2eb975ce733b419ac2e97b134d8ff92b6478b6559feed9a50bdfd82b3",
        ),
        (
            GoalStatusArray::DEFINITION,
            "6c1684b00f177d37438febe6e709fc4e2b0d4248dca4854946f9ed8b30cda83e",
        ),
    ] {
        assert_eq!(
            definition.hash(),
            format!("RIHS01_{hash}"),
            "{}",
            definition.name
        );
    }
}

#[test]
fn a_definition_has_those_of_its_parts_after_it() {
    let text = JointState::DEFINITION.text();
    assert_eq!(
        text,
        format!(
            "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n{line}\nMSG: \
             builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n{line}\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\n\
             string frame_id\n",
            line = "=".repeat(80)
        )
    );
}

#[test]
fn values_lie_at_multiples_of_their_size_after_the_header() {
    let status = DiagnosticStatus {
        level: Byte(2),
        name: "a".into(),
        values: vec![KeyValue {
            key: "k".into(),
            value: String::new(),
        }],
        ..DiagnosticStatus::default()
    };
    let message = Diagnostics {
        header: Header {
            stamp: Time { sec: 1, nanosec: 2 },
            frame_id: String::new(),
        },
        status: vec![status],
    };
    let expected: &[&[u8]] = &[
        &[0, 1, 0, 0],
        &[1, 0, 0, 0, 2, 0, 0, 0],
        // A text counts its closing zero.
        &[1, 0, 0, 0, 0, 0, 0, 0],
        &[1, 0, 0, 0],
        &[2, 0, 0, 0],
        &[2, 0, 0, 0, b'a', 0, 0, 0],
        &[1, 0, 0, 0, 0, 0, 0, 0],
        &[1, 0, 0, 0, 0, 0, 0, 0],
        &[1, 0, 0, 0],
        &[2, 0, 0, 0, b'k', 0, 0, 0],
        &[1, 0, 0, 0, 0],
    ];
    assert_eq!(encode(&message).unwrap(), expected.concat());
}
