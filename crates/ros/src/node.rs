//! A robot as a node: its topics and services on a bridge.

use crate::bridge::{Bridge, BridgeError, Caller, Channel, Incoming, ServiceType};
use crate::convert::Sent;
use crate::messages::Triggered;
use crate::topics::Topic;
use crate::types::encode;
use std::collections::BTreeMap;

/// The node's name.
pub const NAME: &str = "rumbo";

/// The type of its services: without a question, answered by yes or no, and why.
const TRIGGER: ServiceType = ServiceType("std_srvs/srv/Trigger");

/// A node. Topics are announced with their first message.
#[derive(Debug)]
pub struct Node<B> {
    bridge: B,
    namespace: String,
    topics: BTreeMap<Topic, Channel>,
    services: BTreeMap<Channel, usize>,
}

/// Somebody has called a service.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Call {
    /// Which one, in the order in which they are offered.
    pub service: usize,
    /// Who is to be answered.
    pub caller: Caller,
}

impl<B: Bridge> Node<B> {
    /// A node in a namespace (empty, or `/name`).
    pub fn new(bridge: B, namespace: &str) -> Self {
        Self {
            bridge,
            namespace: namespace.to_owned(),
            topics: BTreeMap::new(),
            services: BTreeMap::new(),
        }
    }

    /// The node's name with its namespace, without the first slash: `rumbo`, `first/rumbo`.
    #[must_use]
    pub fn speaker(&self) -> String {
        let name = format!("{}/{NAME}", self.namespace);
        name.trim_start_matches('/').to_owned()
    }

    /// Offers one more service, under the node's name: `arm` is `/rumbo/arm`.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub fn offer(&mut self, service: &str) -> Result<(), BridgeError> {
        let name = format!("/{}/{service}", self.speaker());
        let channel = self.bridge.serve(&name, TRIGGER)?;
        self.services.insert(channel, self.services.len());
        Ok(())
    }

    /// Announces a topic, if that has not been done.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub fn announce(&mut self, topic: Topic) -> Result<Channel, BridgeError> {
        if let Some(channel) = self.topics.get(&topic) {
            return Ok(*channel);
        }
        let name = topic.name_in(&self.namespace);
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
    pub fn publish(&mut self, message: &Sent) -> Result<(), BridgeError> {
        let channel = self.announce(message.topic)?;
        self.bridge.publish(channel, &message.data)
    }

    /// The next call of a service, without waiting.
    pub fn call(&mut self) -> Option<Call> {
        while let Some(incoming) = self.bridge.receive() {
            if let Incoming::Request { caller, .. } = incoming
                && let Some(service) = self.services.get(&caller.service)
            {
                let service = *service;
                return Some(Call { service, caller });
            }
        }
        None
    }

    /// Answers a call: whether it was done, and what there is to say.
    ///
    /// # Errors
    /// If the middleware refuses.
    pub fn answer(&mut self, call: Call, done: Result<(), String>) -> Result<(), BridgeError> {
        let answer = Triggered {
            success: done.is_ok(),
            message: done.err().unwrap_or_default(),
        };
        let data = encode(&answer).map_err(|error| BridgeError::Send(error.to_string()))?;
        self.bridge.answer(call.caller, &data)
    }

    /// What a person should know of the others since the last call.
    pub fn trouble(&mut self) -> Option<String> {
        self.bridge.trouble()
    }
}
