//! A robot as a node: its topics and services on a bridge.

use crate::bridge::{Bridge, BridgeError, Caller, Channel, Incoming};
use crate::navigate;
use crate::parameters;
use rumbo_ros::convert::TopicMessage;
use rumbo_ros::messages::{Triggered, Twist, TwistStamped};
use rumbo_ros::topics::{Quality, Topic};
use rumbo_ros::types::{Message, decode, encode};
use std::collections::BTreeMap;

/// The node's name.
pub(crate) const NAME: &str = "rumbo";

/// The type of its services: without a question, answered by yes or no, and why.
const TRIGGER: &str = "std_srvs/srv/Trigger";

/// A node. Topics are announced with their first message.
#[derive(Debug)]
pub(crate) struct Node<B> {
    bridge: B,
    namespace: String,
    /// Where the clock is.
    world: String,
    topics: BTreeMap<Topic, Channel>,
    services: BTreeMap<Channel, Service>,
    /// Services of [`Service::Call`].
    calls: usize,
    /// Where velocities come from, and whether they are stamped.
    velocities: Option<(Channel, bool)>,
}

/// What a service is for; its number among those.
#[derive(Clone, Copy, Debug)]
enum Service {
    Call(usize),
    Parameters(usize),
    Navigate(usize),
}

/// What others want.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Wish {
    /// A service is called.
    Call(Call),
    /// Something of the robot's parameters.
    Parameters(Caller, parameters::Question),
    /// Something of *go to goal*.
    Navigate(Caller, navigate::Question),
    /// The robot is to drive.
    Drive(Result<Velocity, BadVelocity>),
}

/// A velocity that the robot is to drive at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Velocity {
    /// \[m/s\].
    pub(crate) forward_m_s: f64,
    /// \[rad/s\], positive to the left.
    pub(crate) yaw_rad_s: f64,
    /// Its publisher.
    pub(crate) sender: [u8; 16],
    /// Time since it was sent, by the clocks of both computers \[s\]; `None`: the sender does not say.
    pub(crate) age_s: Option<f64>,
    /// Its own time stamp, if it has one \[ns\].
    pub(crate) stamp_ns: Option<i64>,
}

/// A message that is no velocity: it cannot be decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BadVelocity;

/// Somebody has called a service.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Call {
    /// Which one, in the order in which they are offered.
    pub(crate) service: usize,
    /// Who is to be answered.
    pub(crate) caller: Caller,
}

impl<B: Bridge> Node<B> {
    /// A node in a namespace (empty, or `/name`).
    pub(crate) fn new(bridge: B, namespace: &str) -> Self {
        Self {
            bridge,
            namespace: namespace.to_owned(),
            world: namespace.to_owned(),
            topics: BTreeMap::new(),
            services: BTreeMap::new(),
            calls: 0,
            velocities: None,
        }
    }

    /// The same as one of several robots in a world, whose namespace (empty, or `/name`) has the clock of all.
    #[must_use]
    pub(crate) fn in_world(self, namespace: &str) -> Self {
        let world = namespace.to_owned();
        Self { world, ..self }
    }

    /// Its namespace: empty, or `/name`.
    #[must_use]
    pub(crate) fn namespace(&self) -> &str {
        &self.namespace
    }

    /// The node's name with its namespace, without the first slash: `rumbo`, `first/rumbo`.
    #[must_use]
    pub(crate) fn speaker(&self) -> String {
        let name = format!("{}/{NAME}", self.namespace);
        name.trim_start_matches('/').to_owned()
    }

    /// Offers one more service, under the node's name: `arm` is `/rumbo/arm`.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub(crate) fn offer(&mut self, service: &str) -> Result<(), BridgeError> {
        self.serve(service, TRIGGER, Service::Call(self.calls))?;
        self.calls += 1;
        Ok(())
    }

    /// Offers the robot's parameters.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub(crate) fn offer_parameters(&mut self) -> Result<(), BridgeError> {
        for (number, (name, of)) in parameters::SERVICES.into_iter().enumerate() {
            self.serve(name, of, Service::Parameters(number))?;
        }
        self.announce(Topic::ParameterEvents).map(drop)
    }

    /// Offers *go to goal*.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub(crate) fn offer_navigation(&mut self) -> Result<(), BridgeError> {
        for (number, (name, of)) in navigate::SERVICES.into_iter().enumerate() {
            let name = format!("{}/_action/{name}", navigate::NAME);
            self.serve(&name, of, Service::Navigate(number))?;
        }
        self.announce(Topic::GoalFeedback)?;
        self.announce(Topic::GoalStatus).map(drop)
    }

    fn serve(&mut self, name: &str, kind: &str, is: Service) -> Result<(), BridgeError> {
        let name = format!("/{}/{name}", self.speaker());
        let channel = self.bridge.serve(&name, kind)?;
        self.services.insert(channel, is);
        Ok(())
    }

    /// Announces a topic, if that has not been done.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub(crate) fn announce(&mut self, topic: Topic) -> Result<Channel, BridgeError> {
        if let Some(channel) = self.topics.get(&topic) {
            return Ok(*channel);
        }
        let name = match topic {
            Topic::Clock => topic.name_in(&self.world),
            _ => topic.name_in(&self.namespace),
        };
        let channel = self
            .bridge
            .advertise(&name, topic.definition(), topic.quality())?;
        self.topics.insert(topic, channel);
        Ok(channel)
    }

    /// Publishes a message.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub(crate) fn publish(&mut self, message: &TopicMessage) -> Result<(), BridgeError> {
        let channel = self.announce(message.topic)?;
        self.bridge.publish(channel, &message.data)
    }

    /// Subscribes to velocities: `geometry_msgs/Twist`, or `TwistStamped`. Not reliably: any publisher will do, and what
    /// is old is not sent again.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub(crate) fn take_velocities(&mut self, stamped: bool) -> Result<(), BridgeError> {
        let definition = match stamped {
            true => TwistStamped::DEFINITION,
            false => Twist::DEFINITION,
        };
        let quality = Quality {
            reliable: false,
            latched: false,
            depth: 1,
        };
        let name = format!("{}/cmd_vel", self.namespace);
        let channel = self.bridge.subscribe(&name, definition, quality)?;
        self.velocities = Some((channel, stamped));
        Ok(())
    }

    /// What others want next, without waiting.
    pub(crate) fn wish(&mut self) -> Option<Wish> {
        while let Some(incoming) = self.bridge.receive() {
            match incoming {
                Incoming::Request { caller, data } => {
                    // What cannot be decoded is not answered: who sent it is no client of ours.
                    let wish = match self.services.get(&caller.service) {
                        Some(&Service::Call(service)) => Some(Wish::Call(Call { service, caller })),
                        Some(&Service::Parameters(number)) => parameters::question(number, &data)
                            .map(|question| Wish::Parameters(caller, question)),
                        Some(&Service::Navigate(number)) => navigate::question(number, &data)
                            .map(|question| Wish::Navigate(caller, question)),
                        None => None,
                    };
                    if wish.is_some() {
                        return wish;
                    }
                }
                Incoming::Message {
                    channel,
                    sender,
                    age_s,
                    data,
                } => {
                    if let Some((velocities, stamped)) = self.velocities
                        && velocities == channel
                    {
                        let velocity = velocity(&data, stamped, sender, age_s);
                        return Some(Wish::Drive(velocity));
                    }
                }
            }
        }
        None
    }

    /// Answers a call: whether it was done, and what there is to say.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub(crate) fn answer(
        &mut self,
        call: Call,
        done: Result<(), String>,
    ) -> Result<(), BridgeError> {
        let answer = Triggered {
            success: done.is_ok(),
            message: done.err().unwrap_or_default(),
        };
        self.reply(call.caller, &answer)
    }

    /// Answers somebody.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub(crate) fn reply<M: Message>(
        &mut self,
        caller: Caller,
        answer: &M,
    ) -> Result<(), BridgeError> {
        let data = encode(answer).map_err(|error| BridgeError::Send(error.to_string()))?;
        self.reply_bytes(caller, &data)
    }

    /// The same with an answer that is encoded already.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub(crate) fn reply_bytes(&mut self, caller: Caller, data: &[u8]) -> Result<(), BridgeError> {
        self.bridge.answer(caller, data)
    }

    /// Publishes a message that is not encoded yet.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub(crate) fn send<M: Message>(
        &mut self,
        topic: Topic,
        message: &M,
    ) -> Result<(), BridgeError> {
        let data = encode(message).map_err(|error| BridgeError::Send(error.to_string()))?;
        let channel = self.announce(topic)?;
        self.bridge.publish(channel, &data)
    }

    /// What a person should know of the others since the last call.
    pub(crate) fn trouble(&mut self) -> Option<String> {
        self.bridge.trouble()
    }
}

/// The velocity in a message.
fn velocity(
    data: &[u8],
    stamped: bool,
    sender: [u8; 16],
    age_s: Option<f64>,
) -> Result<Velocity, BadVelocity> {
    /// Along the axes and about them.
    type Content = ([f64; 3], [f64; 3]);
    type Stamped = ((i32, u32, String), Content);
    let (stamp_ns, (linear, angular)) = match stamped {
        true => {
            let ((sec, nanosec, _), twist): Stamped = decode(data).map_err(|_| BadVelocity)?;
            let stamp_ns = i64::from(sec) * 1_000_000_000 + i64::from(nanosec);
            (Some(stamp_ns).filter(|stamp_ns| *stamp_ns != 0), twist)
        }
        false => {
            let twist: Content = decode(data).map_err(|_| BadVelocity)?;
            (None, twist)
        }
    };
    Ok(Velocity {
        forward_m_s: linear[0],
        yaw_rad_s: angular[2],
        sender,
        age_s,
        stamp_ns,
    })
}
