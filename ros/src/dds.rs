//! The bridge over DDS, as `rmw_fastrtps` and `rmw_cyclonedds` of ROS 2 speak it.
//!
//! ```text
//! topic /odom            rt/odom, nav_msgs::msg::dds_::Odometry_
//! service /rumbo/arm     rq/rumbo/armRequest and rr/rumbo/armReply
//! the node               ros_discovery_info: its name, and which writers and readers are its own
//! ```
//!
//! A request is identified by what Fast DDS sends beside the data (the related sample identity of DDS-RPC), or by
//! what Cyclone puts before them: half the client's GUID and a number. Which of both it is, the client's GUID says: it
//! begins with the number of its vendor. Names and types: the design pages of ROS 2 on topic and service names;
//! `rmw_dds_common/msg/ParticipantEntitiesInfo`.

mod domain;
mod farewell;
mod raw;

pub(crate) use domain::Domain;

use crate::bridge::{Bridge, BridgeError, Caller, Channel, Incoming};
use domain::{NodeName, Reader, Writer};
use raw::Raw;
use rumbo_ros::topics::Quality;
use rumbo_ros::types::Definition;
use rustdds::no_key::DeserializedCacheChange;
use rustdds::{
    GUID, RepresentationIdentifier, SampleIdentity, Timestamp, WriteOptionsBuilder, bytes::Bytes,
};
use std::fmt;

/// The vendor's number that a GUID of Cyclone begins with.
const CYCLONE: [u8; 2] = [0x01, 0x10];
/// What Cyclone puts before the data of a service: half a GUID, a number.
const CYCLONE_HEAD: usize = 16;
/// Longest answer to a client that is named beside the data [bytes]: RustDDS 0.15.1 spoils a sample with both such a name
/// and fragments by a byte too many, and its thread ends where that is checked. It makes fragments of what is longer than a
/// packet of Ethernet, of 1,324 bytes.
const LONGEST_NAMED: usize = 1_280;
/// Requests and answers kept.
const SERVICE: Quality = Quality {
    reliable: true,
    latched: false,
    depth: 10,
};
/// Most samples taken from a reader in a row: one that floods does not keep the others waiting.
const IN_A_ROW: usize = 32;

/// What a channel is.
#[allow(
    clippy::large_enum_variant,
    reason = "there are thirty of them, and they are not moved"
)]
enum Carrier {
    Publication(Writer),
    Subscription(Reader),
    Service { requests: Reader, answers: Writer },
}

/// A node on a domain of DDS. Dropping it takes it off the graph.
pub(crate) struct Dds {
    domain: Domain,
    node: NodeName,
    /// Names of the topics used, as DDS has them.
    topics: Vec<String>,
    carriers: Vec<Carrier>,
    /// Where the next message is looked for, and how many there were in a row.
    next: (usize, usize),
}

impl fmt::Debug for Dds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (namespace, name) = &self.node;
        write!(f, "{name} in {namespace} on {:?}", self.domain)
    }
}

impl Dds {
    /// The node of this name in a namespace (empty, or `/name`); no other on this domain has both.
    #[must_use]
    pub(crate) fn new(domain: &Domain, namespace: &str, name: &str) -> Self {
        let namespace = if namespace.is_empty() { "/" } else { namespace };
        let node = (namespace.to_owned(), name.to_owned());
        domain.add(&node);
        Self {
            domain: domain.clone(),
            node,
            topics: Vec::new(),
            carriers: Vec::new(),
            next: (0, 0),
        }
    }

    fn add(
        &mut self,
        name: &str,
        carrier: Result<Carrier, String>,
    ) -> Result<Channel, BridgeError> {
        let announced = |why: String| BridgeError::Announce(name.to_owned(), why);
        self.carriers.push(carrier.map_err(announced)?);
        Ok(self.carriers.len() - 1)
    }

    fn topic(&mut self, name: &str) -> String {
        let topic = format!("rt{name}");
        self.topics.push(topic.clone());
        topic
    }
}

impl Drop for Dds {
    fn drop(&mut self) {
        self.domain.remove(&self.node);
        // Before the domain, which may be left with it.
        self.carriers.clear();
    }
}

/// A ROS 2 name of a type as DDS has it: `std_msgs/msg/String`, `std_msgs::msg::dds_::String_`.
fn dds_type(name: &str, part: &str) -> String {
    match name.rsplit_once('/') {
        Some((package, name)) => format!("{}::dds_::{name}{part}_", package.replace('/', "::")),
        None => name.to_owned(),
    }
}

/// A body in little-endian CDR, of data with their header.
fn body(data: &[u8]) -> Raw {
    Raw {
        encoding: RepresentationIdentifier::CDR_LE,
        body: Bytes::copy_from_slice(data.get(4..).unwrap_or_default()),
    }
}

/// Data with their header.
fn with_header(raw: &Raw, from: usize) -> Option<Vec<u8>> {
    let little = u8::from(raw.encoding == RepresentationIdentifier::CDR_LE);
    Some([&[0, little, 0, 0], raw.body.get(from..)?].concat())
}

/// Seconds since a sample was sent.
fn age_s(sent: Timestamp) -> f64 {
    // Ticks of 2^-32 s.
    let ticks = i128::from(Timestamp::now().to_ticks()) - i128::from(sent.to_ticks());
    ticks as f64 / 2.0_f64.powi(32)
}

fn message(channel: Channel, sample: &DeserializedCacheChange<Raw>) -> Option<Incoming> {
    Some(Incoming::Message {
        channel,
        sender: sample.writer_guid().to_bytes(),
        age_s: sample.source_timestamp().map(age_s),
        data: with_header(&sample.sample, 0)?,
    })
}

/// A request; `None` for one that is too short to be one.
fn request(service: Channel, sample: &DeserializedCacheChange<Raw>) -> Option<Incoming> {
    let writer = sample.writer_guid().to_bytes();
    let raw = &sample.sample;
    if !writer.starts_with(&CYCLONE) {
        let own = SampleIdentity {
            writer_guid: sample.writer_guid(),
            sequence_number: sample.sequence_number,
        };
        let mut related = sample.related_sample_identity().unwrap_or(own);
        // Fast DDS names the client's reader, and leaves the number to the sample.
        if related.sequence_number == rustdds::SequenceNumber::UNKNOWN {
            related.sequence_number = own.sequence_number;
        }
        let caller = Caller {
            service,
            client: related.writer_guid.to_bytes(),
            number: related.sequence_number.into(),
        };
        let data = with_header(raw, 0)?;
        return Some(Incoming::Request { caller, data });
    }
    let head = raw.body.get(..CYCLONE_HEAD)?;
    let mut client = writer;
    client[8..].copy_from_slice(&head[..8]);
    let number: [u8; 8] = head[8..].try_into().ok()?;
    let number = match raw.encoding == RepresentationIdentifier::CDR_LE {
        true => i64::from_le_bytes(number),
        false => i64::from_be_bytes(number),
    };
    let caller = Caller {
        service,
        client,
        number,
    };
    let data = with_header(raw, CYCLONE_HEAD)?;
    Some(Incoming::Request { caller, data })
}

impl Bridge for Dds {
    fn advertise(
        &mut self,
        name: &str,
        of: &Definition,
        quality: Quality,
    ) -> Result<Channel, BridgeError> {
        let (topic, kind) = (self.topic(name), dds_type(of.name, ""));
        let writer = self.domain.writer(&self.node, topic, kind, quality);
        self.add(name, writer.map(Carrier::Publication))
    }

    fn publish(&mut self, topic: Channel, data: &[u8]) -> Result<(), BridgeError> {
        let Some(Carrier::Publication(writer)) = self.carriers.get(topic) else {
            return Err(BridgeError::Send(format!("{topic} is no publication")));
        };
        self.domain.tell().map_err(BridgeError::Send)?;
        let written = writer.write(body(data), Some(Timestamp::now()));
        written.map_err(|error| BridgeError::Send(error.to_string()))
    }

    fn subscribe(
        &mut self,
        name: &str,
        of: &Definition,
        quality: Quality,
    ) -> Result<Channel, BridgeError> {
        let (topic, kind) = (self.topic(name), dds_type(of.name, ""));
        let reader = self.domain.reader(&self.node, topic, kind, quality);
        self.add(name, reader.map(Carrier::Subscription))
    }

    fn serve(&mut self, name: &str, kind: &str) -> Result<Channel, BridgeError> {
        let (request, reply) = (dds_type(kind, "_Request"), dds_type(kind, "_Response"));
        let (asked, answered) = (format!("rq{name}Request"), format!("rr{name}Reply"));
        let requests = self.domain.reader(&self.node, asked, request, SERVICE);
        let answers = self.domain.writer(&self.node, answered, reply, SERVICE);
        let carrier = requests.and_then(|requests| {
            let answers = answers?;
            Ok(Carrier::Service { requests, answers })
        });
        self.add(name, carrier)
    }

    fn receive(&mut self) -> Option<Incoming> {
        // Not published yet: the next time.
        let _ = self.domain.tell();
        for _ in 0..=self.carriers.len() {
            let (channel, in_a_row) = self.next;
            let reader = match self.carriers.get(channel) {
                Some(Carrier::Subscription(reader)) => Some((reader, message as fn(_, &_) -> _)),
                Some(Carrier::Service { requests, .. }) => Some((requests, request as _)),
                Some(Carrier::Publication(_)) | None => None,
            };
            if let Some((reader, understand)) = reader
                && in_a_row < IN_A_ROW
            {
                reader.drain_read_notifications();
                // What cannot be decoded, or is too short, is skipped.
                while let Some(sample) = reader.try_take_one().unwrap_or_default() {
                    if let Some(incoming) = understand(channel, &sample) {
                        self.next.1 += 1;
                        return Some(incoming);
                    }
                }
            }
            self.next = ((channel + 1) % self.carriers.len().max(1), 0);
        }
        None
    }

    fn answer(&mut self, caller: Caller, data: &[u8]) -> Result<(), BridgeError> {
        let Some(Carrier::Service { answers, .. }) = self.carriers.get(caller.service) else {
            let why = format!("{} is no service", caller.service);
            return Err(BridgeError::Send(why));
        };
        let mut raw = body(data);
        let mut options = WriteOptionsBuilder::new().source_timestamp(Timestamp::now());
        if caller.client.starts_with(&CYCLONE) {
            let number = caller.number.to_le_bytes();
            raw.body = [&caller.client[8..], &number, &raw.body].concat().into();
        } else if data.len() > LONGEST_NAMED {
            let length = data.len();
            return Err(BridgeError::Send(format!(
                "an answer of {length} bytes is too long for a client of Fast DDS, {LONGEST_NAMED} are not; let it ask for less at once"
            )));
        } else {
            options = options.related_sample_identity(SampleIdentity {
                writer_guid: GUID::from_bytes(caller.client),
                sequence_number: caller.number.into(),
            });
        }
        let written = answers.write_with_options(raw, options.build());
        written
            .map(drop)
            .map_err(|error| BridgeError::Send(error.to_string()))
    }

    fn trouble(&mut self) -> Option<String> {
        self.domain.trouble(&self.topics)
    }
}
