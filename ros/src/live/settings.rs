//! The robot's parameters for ROS 2: what is read is answered from the table, what is set becomes orders, one after the
//! other; the robot's own answer is the outcome.

use super::{Live, PATIENCE, report};
use crate::bridge::Caller;
use crate::parameters::{self, ParameterState, Question, Value};
use crate::station::Order;
use rumbo_ros::convert::stamp;
use rumbo_ros::service_messages::{Set, SetAtomically, SetParametersResult};
use rumbo_ros::topics::Topic;
use std::collections::VecDeque;
use std::time::Instant;

/// Requests that wait for earlier ones.
const MOST_WAITING: usize = 100;

/// The parameters, and who wants to set them.
#[derive(Default)]
pub(super) struct Settings {
    pub(super) known: Vec<ParameterState>,
    requests: VecDeque<Request>,
}

/// A request to set parameters.
struct Request {
    caller: Caller,
    atomically: bool,
    /// Number and value of each that is not set yet, or why it cannot be; the first one is in turn.
    left: VecDeque<Result<(u8, f32), String>>,
    /// The order for the first one, when it was given, and whether it was seen on its way.
    ordered: Option<(u64, Instant, bool)>,
    done: Vec<Result<(), String>>,
}

impl Settings {
    /// Some are being set.
    pub(super) fn lasts(&self) -> bool {
        !self.requests.is_empty()
    }

    /// The value of a parameter, if it is known.
    pub(super) fn value(&self, name: &str) -> Option<f32> {
        let of_name = |known: &&ParameterState| known.name == name;
        self.known.iter().find(of_name)?.value
    }

    /// Numbers and values by the table.
    fn wanted(&self, (name, value): &(String, Value)) -> Result<(u8, f32), String> {
        let known = self.known.iter().find(|known| known.name == *name);
        let known = known.ok_or_else(|| format!("there is no parameter {name}"))?;
        let number = parameters::number(known, value);
        let number = number.map_err(|why| format!("{name}: {why}"))?;
        Ok((known.id, number))
    }
}

impl Live {
    /// Answers a question, or begins to set what it wants set.
    pub(super) fn ask(&mut self, caller: Caller, question: &Question) {
        let (values, atomically) = match question {
            Question::Set(values) => (values, false),
            Question::SetAtomically(values) => (values, true),
            read => {
                if let Some(Ok(answer)) = parameters::answer(read, &self.settings.known) {
                    // One that is too long for its client.
                    if let Err(error) = self.node.reply_bytes(caller, &answer) {
                        self.warn(error.to_string());
                    }
                }
                return;
            }
        };
        if self.settings.requests.len() >= MOST_WAITING {
            return;
        }
        let wanted = values.iter().map(|value| self.settings.wanted(value));
        let mut left: VecDeque<_> = wanted.collect();
        // All or none: what is refused here comes before what the robot is asked for.
        if atomically && let Some(refused) = left.iter().find(|each| each.is_err()) {
            left = [refused.clone()].into();
        }
        self.settings.requests.push_back(Request {
            caller,
            atomically,
            left,
            ordered: None,
            done: Vec::new(),
        });
    }

    /// Takes what is newly known of the parameters, and says what has changed.
    pub(super) fn know(&mut self, mut known: Vec<ParameterState>) {
        let number = u8::try_from(known.len()).unwrap_or(u8::MAX);
        known.push(ParameterState::use_sim_time(self.state.simulated, number));
        let before = std::mem::replace(&mut self.settings.known, known);
        let node = format!("/{}", self.node.speaker());
        let at = stamp(self.now_ns());
        if let Some(event) = parameters::changes(&node, at, &before, &self.settings.known) {
            let sent = self.node.send(Topic::ParameterEvents, &event);
            report(sent, &mut self.reported);
        }
    }

    /// Gives the orders that are due, and answers what is done; `has_state`: the state is new.
    pub(super) fn set(&mut self, has_state: bool) {
        while let Some(mut request) = self.settings.requests.pop_front() {
            if let Some(done) = self.advance(&mut request, has_state) {
                let is_refused = done.is_err();
                request.done.push(done);
                request.left.pop_front();
                request.ordered = None;
                if request.atomically && is_refused {
                    request.left.clear();
                }
            } else if !request.left.is_empty() {
                self.settings.requests.push_front(request);
                return;
            }
            match request.left.is_empty() {
                true => self.set_done(&request),
                false => self.settings.requests.push_front(request),
            }
        }
    }

    /// The outcome of the parameter in turn, once it is known; orders it first.
    fn advance(&mut self, request: &mut Request, has_state: bool) -> Option<Result<(), String>> {
        let (id, value) = match request.left.front()? {
            Ok(wanted) => *wanted,
            Err(why) => return Some(Err(why.clone())),
        };
        let Some((order, since, on_its_way)) = &mut request.ordered else {
            return match self.station.order(Order::SetParam { id, value }) {
                Ok(order) => {
                    request.ordered = Some((order, Instant::now(), false));
                    None
                }
                Err(why) => Some(Err(why)),
            };
        };
        let known = self.settings.known.get(usize::from(id))?;
        let ended = *on_its_way && !known.pending;
        *on_its_way |= known.pending;
        let is_taken = has_state && self.station.has_taken(*order);
        let is_settled = is_taken && !known.pending && self.state.link.unacknowledged == 0;
        let name = &known.name;
        if is_taken && let Some(why) = &self.state.refused {
            return Some(Err(why.clone()));
        }
        if ended || is_settled {
            let refused = known.refused.as_ref();
            return Some(refused.map_or(Ok(()), |why| Err(format!("{name}: {why}"))));
        }
        let late = || Err(format!("{name}: the robot has not confirmed it"));
        (since.elapsed() > PATIENCE).then(late)
    }

    fn set_done(&mut self, request: &Request) {
        let result = |done: &Result<(), String>| SetParametersResult {
            successful: done.is_ok(),
            reason: done.clone().err().unwrap_or_default(),
        };
        let answered = if request.atomically {
            let set = request.done.iter().filter(|done| done.is_ok()).count();
            let mut result = request.done.last().map_or_else(|| result(&Ok(())), result);
            if !result.successful && set > 0 {
                // The link has failed between them; what was set is not taken back.
                result.reason += &format!("; the first {set} are set");
            }
            self.node.reply(request.caller, &SetAtomically { result })
        } else {
            let results = request.done.iter().map(result).collect();
            self.node.reply(request.caller, &Set { results })
        };
        report(answered, &mut self.reported);
    }
}
