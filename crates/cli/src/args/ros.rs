//! Options of `rumbo ros`.

use super::live::{ConnectArgs, LabArgs};
use super::values::positive_speed;
use crate::failure::Failure;
use crate::ros::{domain, namespace};
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Options of `rumbo ros`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo ros lab
  rumbo ros lab --scenario mode8-goals --namespace first --port 8361
  rumbo ros lab --robots 4
  rumbo ros connect /dev/rfcomm0 --domain 7
  rumbo ros replay out/mode1-7.mcap --speed 2

No ROS installation is needed. Connecting arms nothing; STOP of the dashboard always stops the robot. ROS 2 asks nobody for a password:
with --network everyone in the networks of this computer can drive the robot. docs/ros2.md has topics and services.")]
pub(crate) struct RosArgs {
    #[command(subcommand)]
    pub(crate) source: RosSource,
    #[command(flatten)]
    pub(crate) node: NodeArgs,
}

impl RosArgs {
    /// A robot that is offered as a serial port has no session that could be a node.
    ///
    /// # Errors
    /// That one is asked for.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        match &self.source {
            #[cfg(unix)]
            RosSource::Lab(lab) if lab.pty => Err(Failure::input(
                "--pty offers the robot to another program: run `rumbo lab --pty`, then `rumbo ros connect` with the port",
            )),
            _ => Ok(()),
        }
    }
}

/// What becomes a node.
#[derive(Debug, Subcommand)]
pub(crate) enum RosSource {
    /// A simulated robot, with its dashboard
    #[command(after_help = "\
Examples:
  rumbo ros lab
  rumbo ros lab --scenario mode8-goals --no-browser")]
    Lab(Box<LabArgs>),
    /// A real robot, with its dashboard
    #[command(after_help = "\
Examples:
  rumbo ros connect /dev/rfcomm0
  rumbo ros connect tcp:192.168.1.7:2000 --network")]
    Connect(Box<ConnectArgs>),
    /// A log, once
    Replay(PlayArgs),
}

/// The node.
#[derive(Args, Debug)]
pub(crate) struct NodeArgs {
    /// Namespace of the node and of its topics; of several robots each has its own below it
    #[arg(long, value_name = "NAME", global = true, default_value = "", hide_default_value = true, value_parser = namespace)]
    pub(crate) namespace: String,
    /// Domain, 0..232 [default: ROS_DOMAIN_ID, or else 0]
    #[arg(long, value_name = "N", global = true, value_parser = domain)]
    pub(crate) domain: Option<u16>,
    /// Velocities on cmd_vel are geometry_msgs/TwistStamped instead of Twist
    #[arg(long, global = true)]
    pub(crate) stamped: bool,
    /// Whose nav2_msgs the clients of navigate_to_pose have
    #[arg(long, value_enum, value_name = "NAME", global = true, default_value_t = Distribution::Jazzy)]
    pub(crate) distribution: Distribution,
    /// Be there for other computers too, in all networks of this one: everyone there can drive the robot
    #[arg(long, global = true)]
    pub(crate) network: bool,
}

/// A distribution of ROS 2, as far as it matters here.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Distribution {
    /// Humble
    Humble,
    /// Iron and Jazzy
    Jazzy,
    /// Kilted and newer
    Kilted,
}

/// Options of `rumbo ros replay`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo ros replay out/mode1-7.mcap
  rumbo ros replay out/mode1-7.mcap --speed 2 --namespace first")]
pub(crate) struct PlayArgs {
    /// The log
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// Seconds of the log per second
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = positive_speed)]
    pub(crate) speed: f64,
}
