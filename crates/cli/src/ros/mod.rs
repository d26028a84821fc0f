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
use rumbo_ros::bridge::{BridgeError, Reach};
use rumbo_ros::dds::{Dds, Domain};
use rumbo_ros::navigate;
use rumbo_ros::node::{self, Node};
use rumbo_station::Lab;
use session::{Live, Times};
use std::thread::JoinHandle;
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
    let joined = Joined::new(&args.node)?;
    match &mut args.source {
        RosSource::Lab(lab) => {
            let served = lab::serve(lab, Some(output::aside))?;
            let live = joined.live(&served, Times::Simulated, &args.node)?;
            beside(served, live, lab.session.serve)
        }
        RosSource::Connect(connect) => {
            let served = connect::serve(connect)?;
            let live = joined.live(&served, Times::OfDay, &args.node)?;
            beside(served, live, connect.session.serve)
        }
        RosSource::Replay(log) => {
            let node = joined.node(&args.node.namespace);
            joined.say(&[node.speaker()]);
            play::play(log, node)
        }
    }
}

/// A domain that is joined.
struct Joined {
    domain: Domain,
    number: u16,
    reach: Reach,
}

impl Joined {
    fn new(args: &NodeArgs) -> Result<Self, Failure> {
        let number = match (args.domain, std::env::var(DOMAIN)) {
            (Some(domain), _) => domain,
            (None, Err(_)) => 0,
            (None, Ok(text)) => domain(text.trim())
                .map_err(|why| Failure::Input(format!("{DOMAIN} = {text:?}: {why}")))?,
        };
        let reach = match args.network {
            true => Reach::Networks,
            false => Reach::Computer,
        };
        let domain = Domain::join(number, reach).map_err(Failure::input)?;
        Ok(Self {
            domain,
            number,
            reach,
        })
    }

    fn node(&self, namespace: &str) -> RosNode {
        Node::new(Dds::new(&self.domain, namespace, node::NAME), namespace)
    }

    /// A node for each robot of a session: in the namespace asked for, and of several each in its own below it.
    fn live(&self, served: &Lab, times: Times, args: &NodeArgs) -> Result<Vec<Live>, Failure> {
        let clients = served.clients();
        let clients =
            clients.ok_or_else(|| Failure::input("no place for a node in the session"))?;
        let mut lives = Vec::new();
        let mut speakers = Vec::new();
        for (robot, client) in clients {
            let own = namespace(&robot).map_err(|_| {
                Failure::Input(format!(
                    "robot {robot}: a name of ROS 2 begins with a letter or _; give it another name in its [[fleet]]"
                ))
            })?;
            let node = self.node(&(args.namespace.clone() + &own));
            let node = node.in_world(&args.namespace);
            let times = match times {
                Times::Simulated if !lives.is_empty() => Times::SimulatedWithOthers,
                times => times,
            };
            speakers.push(node.speaker());
            lives.push(Live::new(node, client, times, args).map_err(Failure::input)?);
        }
        self.say(&speakers);
        Ok(lives)
    }

    /// Says which nodes there are.
    fn say(&self, speakers: &[String]) {
        let whom = match self.reach {
            Reach::Networks => "for all in its networks",
            Reach::Computer => "for this computer",
        };
        let node = if speakers.len() > 1 { "nodes" } else { "node" };
        let (speakers, number) = (speakers.join(", /"), self.number);
        output::aside(&format!(
            "ROS 2: {node} /{speakers} on domain {number}, {whom}"
        ));
    }
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

/// Runs the nodes beside a session, until that ends.
fn beside(served: Lab, lives: Vec<Live>, serve: ServeArgs) -> Result<(), Failure> {
    let begin = |live: Live| {
        let thread = std::thread::Builder::new().name("ros".into());
        thread.spawn(move || live.run()).map_err(Failure::input)
    };
    let threads: Vec<_> = lives.into_iter().map(begin).collect::<Result<_, _>>()?;
    let shown = browser::show(served, serve);
    let ended: Vec<_> = threads.into_iter().map(JoinHandle::join).collect();
    shown?;
    for ended in ended {
        match ended {
            Ok(ended) => ended.map_err(Failure::input)?,
            Err(_) => return Err(Failure::input("the node of ROS 2 has failed")),
        }
    }
    Ok(())
}

/// A node that cannot publish is reported, and the session goes on.
fn report(outcome: Result<(), BridgeError>, reported: &mut bool) {
    if let Err(error) = outcome
        && !std::mem::replace(reported, true)
    {
        output::note(&format!("ROS 2: {error}"));
    }
}
