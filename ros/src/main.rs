//! `rumbo-ros`: the robots of a running `rumbo` as nodes of ROS 2 over DDS.
//!
//! ```text
//! address    where a station is, and the key to it
//! station    the session, over the WebSocket of a page: what is new, orders
//! live       its node: what is new becomes messages; calls, velocities, settings and goals become orders
//! node       topics, services and an action on a bridge; parameters, navigate: what they carry
//! bridge     what a node asks of a middleware; dds: over DDS
//! ```
//!
//! It is one of the clients of the dashboard: the same messages, the same lease of control. The messages of ROS 2 are
//! those that bags of logs have, made by the same code (`rumbo_ros`).

mod address;
mod aim;
mod args;
mod bridge;
mod dds;
mod live;
mod navigate;
mod node;
mod output;
mod parameters;
mod station;
#[cfg(test)]
mod tests;

use args::{Args, namespace};
use bridge::Reach;
use clap::Parser;
use dds::{Dds, Domain};
use live::Live;
use node::Node;
use signal_hook::consts::{SIGINT, SIGTERM};
use station::Station;
use std::error::Error;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output::say(&format!("error: {error}"));
            ExitCode::from(2)
        }
    }
}

fn run(args: &Args) -> Result<(), Box<dyn Error>> {
    let ends = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // The second one ends the program at once.
        signal_hook::flag::register_conditional_default(signal, Arc::clone(&ends))?;
        signal_hook::flag::register(signal, Arc::clone(&ends))?;
    }
    let reach = match args.network {
        true => Reach::Networks,
        false => Reach::Computer,
    };
    let stations = station::join(&args.address, |error| {
        output::note(&format!("waiting: {error}"));
    })?;
    let names: Vec<String> = stations.iter().map(name).collect::<Result<_, _>>()?;
    let domain = Domain::join(args.domain, reach)?;
    let (mut lives, mut speakers) = (Vec::new(), Vec::new());
    for (station, own) in stations.into_iter().zip(names) {
        let namespace = args.namespace.clone() + &own;
        let node = Node::new(Dds::new(&domain, &namespace, node::NAME), &namespace);
        let node = node.in_world(&args.namespace);
        speakers.push(node.speaker());
        let is_first = lives.is_empty();
        lives.push(Live::new(node, station, is_first, args)?);
    }
    let nodes = if lives.len() > 1 { "nodes" } else { "node" };
    let whom = match reach {
        Reach::Networks => "for all in its networks",
        Reach::Computer => "for this computer",
    };
    let (speakers, number) = (speakers.join(", /"), args.domain);
    output::say(&format!(
        "ROS 2: {nodes} /{speakers} on domain {number}, {whom}"
    ));
    all(lives, &ends)
}

/// The namespace of a robot among several.
fn name(station: &Station) -> Result<String, String> {
    namespace(&station.robot).map_err(|_| {
        format!(
            "robot {}: a name of ROS 2 begins with a letter or _; give it another name in its [[fleet]]",
            station.robot
        )
    })
}

/// Runs the nodes, each in a thread of its own, until their session ends or the program is to.
fn all(lives: Vec<Live>, ends: &Arc<AtomicBool>) -> Result<(), Box<dyn Error>> {
    let mut threads = Vec::new();
    for live in lives {
        let ends = Arc::clone(ends);
        let thread = std::thread::Builder::new().name("node".into());
        threads.push(thread.spawn(move || live.run(&ends).map_err(|error| error.to_string()))?);
    }
    let ended: Vec<_> = threads.into_iter().map(|thread| thread.join()).collect();
    for ended in ended {
        ended.map_err(|_| "a node has failed")??;
    }
    Ok(())
}
