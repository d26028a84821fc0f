//! A node on a bridge that only notes what it is asked for.

use crate::bridge::{Bridge, BridgeError, Caller, Channel, Incoming};
use crate::node::{BadVelocity, Node, Wish};
use rumbo_ros::convert::clock;
use rumbo_ros::messages::{Header, Time, Twist, TwistStamped, Vector3};
use rumbo_ros::topics::{Quality, Topic};
use rumbo_ros::types::{Definition, encode};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

/// What was asked for, in words, and what is to come in.
#[derive(Clone, Debug, Default)]
struct Noted {
    asked: Rc<RefCell<Vec<String>>>,
    incoming: Rc<RefCell<VecDeque<Incoming>>>,
}

impl Noted {
    fn note(&self, text: String) -> Result<Channel, BridgeError> {
        let mut asked = self.asked.borrow_mut();
        asked.push(text);
        Ok(asked.len() - 1)
    }

    fn asked(&self) -> Vec<String> {
        self.asked.borrow().clone()
    }
}

impl Bridge for Noted {
    fn advertise(
        &mut self,
        name: &str,
        of: &Definition,
        _: Quality,
    ) -> Result<Channel, BridgeError> {
        self.note(format!("publishes {name} {}", of.name))
    }

    fn publish(&mut self, topic: Channel, data: &[u8]) -> Result<(), BridgeError> {
        self.note(format!("{topic}: {} bytes", data.len()))
            .map(drop)
    }

    fn subscribe(
        &mut self,
        name: &str,
        of: &Definition,
        quality: Quality,
    ) -> Result<Channel, BridgeError> {
        let how = if quality.reliable { "reliable" } else { "any" };
        self.note(format!("reads {name} {} {how}", of.name))
    }

    fn serve(&mut self, name: &str, kind: &str) -> Result<Channel, BridgeError> {
        self.note(format!("serves {name} {kind}"))
    }

    fn receive(&mut self) -> Option<Incoming> {
        self.incoming.borrow_mut().pop_front()
    }

    fn answer(&mut self, caller: Caller, data: &[u8]) -> Result<(), BridgeError> {
        self.note(format!("answers {}: {data:?}", caller.number))
            .map(drop)
    }

    fn trouble(&mut self) -> Option<String> {
        None
    }
}

#[test]
fn a_namespace_holds_all_but_what_tools_look_for_in_one_place() {
    let bridge = Noted::default();
    let mut node = Node::new(bridge.clone(), "/first");
    node.offer("arm").unwrap();
    node.take_velocities(true).unwrap();
    for topic in [Topic::Odometry, Topic::Diagnostics, Topic::Events] {
        node.announce(topic).unwrap();
    }
    node.publish(&clock(1).unwrap()).unwrap();
    // Announced once.
    node.publish(&clock(2).unwrap()).unwrap();
    assert_eq!(
        bridge.asked(),
        [
            "serves /first/rumbo/arm std_srvs/srv/Trigger",
            "reads /first/cmd_vel geometry_msgs/msg/TwistStamped any",
            "publishes /first/odom nav_msgs/msg/Odometry",
            "publishes /diagnostics diagnostic_msgs/msg/DiagnosticArray",
            "publishes /rosout rcl_interfaces/msg/Log",
            "publishes /first/clock rosgraph_msgs/msg/Clock",
            "5: 12 bytes",
            "5: 12 bytes",
        ]
    );
    assert_eq!(node.speaker(), "first/rumbo");
    assert_eq!(Node::new(Noted::default(), "").speaker(), "rumbo");
}

#[test]
fn a_call_is_answered_with_the_reason_of_a_refusal() {
    let bridge = Noted::default();
    let mut node = Node::new(bridge.clone(), "");
    node.offer("arm").unwrap();
    node.offer("stop").unwrap();
    let caller = |service| Caller {
        service,
        client: [7; 16],
        number: 3,
    };
    // The last one is for no service of ours.
    for service in [1, 9] {
        bridge.incoming.borrow_mut().push_back(Incoming::Request {
            caller: caller(service),
            data: vec![0, 1, 0, 0, 0],
        });
    }
    let Some(Wish::Call(call)) = node.wish() else {
        panic!("no call");
    };
    assert_eq!((call.service, call.caller), (1, caller(1)));
    assert_eq!(node.wish(), None);
    node.answer(call, Ok(())).unwrap();
    node.answer(call, Err("no".into())).unwrap();
    assert_eq!(
        bridge.asked()[2..],
        [
            "answers 3: [0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0]",
            "answers 3: [0, 1, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 110, 111, 0]",
        ]
    );
}

/// The velocity that a node makes of a message.
fn velocity(data: Vec<u8>, stamped: bool) -> Result<(f64, f64, Option<i64>), BadVelocity> {
    let bridge = Noted::default();
    let mut node = Node::new(bridge.clone(), "");
    node.take_velocities(stamped).unwrap();
    bridge.incoming.borrow_mut().push_back(Incoming::Message {
        channel: 0,
        sender: [0; 16],
        age_s: None,
        data,
    });
    let Some(Wish::Drive(velocity)) = node.wish() else {
        panic!("no velocity");
    };
    velocity.map(|it| (it.forward_m_s, it.yaw_rad_s, it.stamp_ns))
}

#[test]
fn a_velocity_is_read_with_and_without_a_stamp_in_either_byte_order() {
    let along = |x, z| Vector3 { x, y: 9.0, z };
    let twist = Twist {
        linear: along(0.5, 8.0),
        angular: along(7.0, -0.25),
    };
    let bytes = encode(&twist).unwrap();
    assert_eq!(velocity(bytes.clone(), false), Ok((0.5, -0.25, None)));
    let mut big = vec![0, 0, 0, 0];
    for number in bytes[4..].chunks(8) {
        big.extend(number.iter().rev());
    }
    assert_eq!(velocity(big, false), Ok((0.5, -0.25, None)));
    let stamped = |sec, nanosec| {
        let stamp = Time { sec, nanosec };
        let header = Header {
            stamp,
            frame_id: "base_link".into(),
        };
        let twist = twist.clone();
        velocity(encode(&TwistStamped { header, twist }).unwrap(), true)
    };
    assert_eq!(stamped(2, 5), Ok((0.5, -0.25, Some(2_000_000_005))));
    assert_eq!(stamped(0, 0), Ok((0.5, -0.25, None)));
    for short in [0, 3, 4, 20, 51] {
        assert_eq!(velocity(bytes[..short].to_vec(), false), Err(BadVelocity));
    }
}
