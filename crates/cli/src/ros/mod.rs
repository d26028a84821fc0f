//! `rumbo ros`: a robot, or the log of one, as a node of ROS 2.

mod aim;
mod calls;
mod drive;
mod goal;
mod parameters;
mod play;
mod session;

use crate::args::{Distribution, NodeArgs, RosArgs, RosSource, ServeArgs};
use crate::failure::Failure;
use crate::{browser, connect, lab, output};
use rumbo_ros::bridge::BridgeError;
use rumbo_ros::dds::{Dds, Reach};
use rumbo_ros::navigate;
use rumbo_ros::node::{self, Node};
use rumbo_station::{Client, Lab};
use session::Live;
use std::time::Duration;

/// The environment's variable that names the domain.
const DOMAIN: &str = "ROS_DOMAIN_ID";
/// Largest domain whose ports exist.
const LAST_DOMAIN: u16 = 232;
/// Between two looks at what is new.
const WAKE: Duration = Duration::from_millis(4);

type RosNode = Node<Dds>;

/// Joins the domain first: where that is refused, nothing is opened.
pub(crate) fn ros(args: &mut RosArgs) -> Result<(), Failure> {
    args.check()?;
    let node = join(&args.node)?;
    match &mut args.source {
        RosSource::Lab(lab) => {
            let served = lab::serve(lab)?;
            let live = Live::new(node, client(&served)?, true, &args.node);
            beside(served, live, lab.session.serve)
        }
        RosSource::Connect(connect) => {
            let served = connect::serve(connect)?;
            let live = Live::new(node, client(&served)?, false, &args.node);
            beside(served, live, connect.session.serve)
        }
        RosSource::Replay(log) => play::play(log, node),
    }
}

fn join(args: &NodeArgs) -> Result<RosNode, Failure> {
    let domain = match (args.domain, std::env::var(DOMAIN)) {
        (Some(domain), _) => domain,
        (None, Err(_)) => 0,
        (None, Ok(text)) => domain(text.trim())
            .map_err(|why| Failure::Input(format!("{DOMAIN} = {text:?}: {why}")))?,
    };
    let reach = match args.network {
        true => Reach::Networks,
        false => Reach::Computer,
    };
    let bridge = Dds::join(domain, reach, &args.namespace, node::NAME).map_err(Failure::input)?;
    let node = Node::new(bridge, &args.namespace);
    let whom = match reach {
        Reach::Networks => "for all in its networks",
        Reach::Computer => "for this computer",
    };
    let name = node.speaker();
    output::aside(&format!("ROS 2: node /{name} on domain {domain}, {whom}"));
    Ok(node)
}

/// The definitions of Nav2 that clients have.
fn definitions(distribution: Distribution) -> navigate::Distribution {
    match distribution {
        Distribution::Humble => navigate::Distribution::Humble,
        Distribution::Jazzy => navigate::Distribution::Jazzy,
        Distribution::Kilted => navigate::Distribution::Kilted,
    }
}

/// A domain as it is written.
pub(crate) fn domain(text: &str) -> Result<u16, String> {
    let domain = text.parse().ok().filter(|domain| *domain <= LAST_DOMAIN);
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

fn client(served: &Lab) -> Result<Client, Failure> {
    let client = served.client();
    client.ok_or_else(|| Failure::input("no place for a node in the session"))
}

/// Runs the node beside a session, until that ends.
fn beside(served: Lab, live: Result<Live, BridgeError>, serve: ServeArgs) -> Result<(), Failure> {
    let live = live.map_err(Failure::input)?;
    let thread = std::thread::Builder::new().name("ros".into());
    let thread = thread.spawn(move || live.run()).map_err(Failure::input)?;
    let shown = browser::show(served, serve);
    let ended = thread.join();
    shown?;
    match ended {
        Ok(ended) => ended.map_err(Failure::input),
        Err(_) => Err(Failure::input("the node of ROS 2 has failed")),
    }
}

/// A node that cannot publish is reported, and the session goes on.
fn report(outcome: Result<(), BridgeError>, reported: &mut bool) {
    if let Err(error) = outcome
        && !std::mem::replace(reported, true)
    {
        output::note(&format!("ROS 2: {error}"));
    }
}
