//! A robot in the messages of ROS 2: a log becomes a bag, without a ROS installation.
//!
//! ```text
//! types      what a message is made of: its definition as text, its hash (REP 2016)
//! messages   the messages used here
//! geometry   frames and body of a robot; its URDF
//! surroundings   maps and markers: the world, the goals, the way; the sonars as a scan
//! topics     the topics of a robot: names, types, quality of service
//! convert    a log, or what happens, as messages by topic
//! bag        the bag: an MCAP file and its metadata
//! service_messages   what services and an action carry, for a node
//! numbers    the numbers in any message, by the text of its definition
//! recorded   bags of others: their messages, from MCAP and from SQLite
//! ```
//!
//! The node itself is a program of its own, in `ros/`, which makes its messages with this crate.
//!
//! Frames follow REP 103 (x forward, y left, counter-clockwise; metres, radians) and REP 105 (`map`, `odom`,
//! `base_link`). `base_link` is the middle of the wheels' axis, on the floor.

pub mod bag;
pub mod convert;
pub mod geometry;
pub mod messages;
pub mod numbers;
pub mod recorded;
pub mod service_messages;
mod sqlite;
mod surroundings;
pub mod topics;
pub mod types;
