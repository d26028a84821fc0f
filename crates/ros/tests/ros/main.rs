//! A robot as a node of ROS 2.

mod convert;
mod navigate;
mod node;
mod parameters;
mod types;
