//! The command line.

use crate::address::Address;
use crate::navigate::Distribution;
use clap::Parser;

/// The environment's variable that names the domain.
const DOMAIN: &str = "ROS_DOMAIN_ID";
/// Largest domain whose ports exist.
const LAST_DOMAIN: u16 = 232;

/// Shows the robots of a running `rumbo lab` or `rumbo connect` to ROS 2 as nodes, and lets them be driven from there.
#[derive(Debug, Parser)]
#[command(
    version,
    after_help = "\
Examples:
  rumbo-ros
  rumbo-ros http://127.0.0.1:8361/ --namespace first
  rumbo-ros 'http://192.168.1.7:8360/?token=...' --domain 7

No ROS installation is needed. Joining arms nothing; STOP of the dashboard always stops the robot. ROS 2 asks nobody for a password:
with --network everyone in the networks of this computer can drive the robot. docs/ros2.md has topics and services."
)]
pub(crate) struct Args {
    /// Address of the dashboard, as rumbo prints it; without its token on the same computer, where the key is in a file of yours
    #[arg(value_name = "ADDRESS", default_value = "http://127.0.0.1:8360/")]
    pub(crate) address: Address,
    /// Namespace of the node and of its topics; of several robots each has its own below it
    #[arg(long, value_name = "NAME", default_value = "", hide_default_value = true, value_parser = namespace)]
    pub(crate) namespace: String,
    /// Domain, 0..232
    #[arg(long, value_name = "N", env = DOMAIN, default_value = "0", value_parser = domain)]
    pub(crate) domain: u16,
    /// Velocities on cmd_vel are geometry_msgs/TwistStamped instead of Twist
    #[arg(long)]
    pub(crate) stamped: bool,
    /// The sonars as one sensor_msgs/LaserScan on scan, besides
    #[arg(long)]
    pub(crate) scan: bool,
    /// Whose nav2_msgs the clients of navigate_to_pose have
    #[arg(long, value_enum, value_name = "NAME", default_value_t = Distribution::Jazzy)]
    pub(crate) distribution: Distribution,
    /// Be there for other computers too, in all networks of this one: everyone there can drive the robot
    #[arg(long)]
    pub(crate) network: bool,
}

/// A domain as it is written.
fn domain(text: &str) -> Result<u16, String> {
    let domain = text.trim().parse().ok();
    let domain = domain.filter(|domain| *domain <= LAST_DOMAIN);
    domain.ok_or_else(|| format!("a domain is a number within 0..{LAST_DOMAIN}"))
}

/// A namespace as it is written: empty, or `/name`, with further names after it.
pub(crate) fn namespace(text: &str) -> Result<String, String> {
    let names = text.trim_matches('/');
    let is_name = |name: &str| {
        let begins = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        begins && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    match names.is_empty() || names.split('/').all(is_name) {
        true if names.is_empty() => Ok(String::new()),
        true => Ok(format!("/{names}")),
        false => {
            Err("a namespace has letters, digits and _, no digit first, as in `left_robot`".into())
        }
    }
}
