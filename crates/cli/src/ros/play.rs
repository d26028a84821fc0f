//! A log played to ROS 2: the messages of its bag at their times, and the clock.

use super::{RosNode, WAKE, report};
use crate::args::PlayArgs;
use crate::export::warn_if_cut;
use crate::failure::Failure;
use crate::interrupt;
use rumbo_ros::convert::{Sent, clock, messages};
use rumbo_station::log_file;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Others find a node within this time; what is published before is lost to them.
const FOUND: Duration = Duration::from_secs(1);
/// Between two messages of the clock, in the log's time [ns].
const CLOCK_NS: u64 = 20_000_000;

/// Plays a log once.
pub(super) fn play(args: &PlayArgs, mut node: RosNode) -> Result<(), Failure> {
    let interrupted = interrupt::asked();
    let log = log_file::read(&args.log).map_err(Failure::input)?;
    warn_if_cut(&args.log, &log)?;
    let wrong = |error| Failure::Input(format!("{}: {error}", args.log.display()));
    let messages = with_clock(messages(&log).map_err(wrong)?)?;
    for message in &messages {
        node.announce(message.topic).map_err(Failure::input)?;
    }
    let first_ns = messages.first().map_or(0, |message| message.t_ns);
    let began = Instant::now() + FOUND;
    let mut reported = false;
    for message in &messages {
        let since_s = (message.t_ns - first_ns) as f64 / 1e9 / args.speed;
        let due = began + Duration::from_secs_f64(since_s);
        loop {
            if interrupted.load(Ordering::Relaxed) {
                return Err(Failure::Interrupted);
            }
            let wait = due.saturating_duration_since(Instant::now());
            if wait.is_zero() {
                break;
            }
            std::thread::sleep(wait.min(10 * WAKE));
        }
        report(node.publish(message), &mut reported);
    }
    // The last ones are on their way.
    std::thread::sleep(FOUND);
    Ok(())
}

/// The messages with those of the clock among them.
fn with_clock(messages: Vec<Sent>) -> Result<Vec<Sent>, Failure> {
    let mut all = Vec::new();
    let mut due_ns = 0;
    for message in messages {
        if message.t_ns >= due_ns {
            due_ns = message.t_ns + CLOCK_NS;
            all.push(clock(message.t_ns).map_err(Failure::input)?);
        }
        all.push(message);
    }
    Ok(all)
}
