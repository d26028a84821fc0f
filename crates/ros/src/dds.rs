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

use crate::bridge::{Bridge, BridgeError, Caller, Channel, Incoming, ServiceType};
use crate::topics::Quality;
use crate::types::Definition;
use rustdds::no_key::{DataWriter, Decode, DefaultDecoder, DeserializerAdapter};
use rustdds::no_key::{DeserializedCacheChange, SerializerAdapter, SimpleDataReader};
use rustdds::policy::{Durability, History, Lifespan};
use rustdds::{
    DomainParticipant, DomainParticipantBuilder, DomainParticipantStatusEvent as Status,
    DomainParticipantStatusListener, Duration, GUID, Publisher, QosPolicies, QosPolicyBuilder,
    RTPSEntity, RepresentationIdentifier, SampleIdentity, StatusEvented, Subscriber, Timestamp,
    Topic, TopicKind, WriteOptionsBuilder, bytes::Bytes,
};
use serde::Serialize;
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::fmt;
use std::net::Ipv4Addr;

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

/// Data as they are.
#[derive(Clone, Debug)]
struct Raw {
    encoding: RepresentationIdentifier,
    body: Bytes,
}

/// Passes data on as they are.
#[derive(Clone)]
struct AsIs;

impl SerializerAdapter<Raw> for AsIs {
    type Error = Infallible;

    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn to_bytes(value: &Raw) -> Result<Bytes, Infallible> {
        Ok(value.body.clone())
    }
}

impl DeserializerAdapter<Raw> for AsIs {
    type Error = Infallible;
    type Decoded = Raw;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &[
            RepresentationIdentifier::CDR_LE,
            RepresentationIdentifier::CDR_BE,
        ]
    }

    fn transform_decoded(decoded: Raw) -> Raw {
        decoded
    }
}

impl DefaultDecoder<Raw> for AsIs {
    type Decoder = Self;
    const DECODER: Self = Self;
}

impl Decode<'_, Raw> for AsIs {
    type Error = Infallible;

    fn decode_bytes(
        self,
        input_bytes: &[u8],
        encoding: RepresentationIdentifier,
    ) -> Result<Raw, Infallible> {
        let body = Bytes::copy_from_slice(input_bytes);
        Ok(Raw { encoding, body })
    }
}

type Writer = DataWriter<Raw, AsIs>;
type Reader = SimpleDataReader<Raw, AsIs>;

/// `rmw_dds_common/msg/ParticipantEntitiesInfo`, with identities of 16 bytes as Iron and newer have them.
#[derive(Serialize)]
struct Participant<'a> {
    gid: [u8; 16],
    nodes: Vec<NodeEntities<'a>>,
}

#[derive(Serialize)]
struct NodeEntities<'a> {
    namespace: &'a str,
    name: &'a str,
    readers: &'a [[u8; 16]],
    writers: &'a [[u8; 16]],
}

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

/// Who may find the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// This computer. No wall: it is only not announced elsewhere.
    Computer,
    /// All networks that this computer is in.
    Networks,
}

/// A node on a domain of DDS. Dropping it takes it off the graph.
pub struct Dds {
    participant: DomainParticipant,
    publisher: Publisher,
    subscriber: Subscriber,
    statuses: DomainParticipantStatusListener,
    graph: Writer,
    namespace: String,
    name: String,
    readers: Vec<[u8; 16]>,
    writers: Vec<[u8; 16]>,
    carriers: Vec<Carrier>,
    /// Types of the topics used, by name.
    types: BTreeMap<String, String>,
    /// Where the next message is looked for, and how many there were in a row.
    next: (usize, usize),
}

impl fmt::Debug for Dds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{} on DDS", self.namespace, self.name)
    }
}

/// A quality of service in the terms of DDS.
fn policies(quality: Quality) -> QosPolicies {
    let durability = match quality.latched {
        true => Durability::TransientLocal,
        false => Durability::Volatile,
    };
    let builder = QosPolicyBuilder::new();
    let builder = match quality.reliable {
        true => builder.reliable(Duration::ZERO),
        false => builder.best_effort(),
    };
    builder
        .durability(durability)
        .history(History::KeepLast {
            depth: quality.depth,
        })
        .lifespan(Lifespan {
            duration: Duration::INFINITE,
        })
        .build()
}

/// A ROS 2 name of a type as DDS has it: `std_msgs/msg/String`, `std_msgs::msg::dds_::String_`.
fn dds_type(name: &str, part: &str) -> String {
    match name.rsplit_once('/') {
        Some((package, name)) => format!("{}::dds_::{name}{part}_", package.replace('/', "::")),
        None => name.to_owned(),
    }
}

impl Dds {
    /// Joins a domain as the node of this name in a namespace (empty, or `/name`).
    ///
    /// # Errors
    /// If there is no such domain, no network, or no free port.
    pub fn join(
        domain: u16,
        reach: Reach,
        namespace: &str,
        name: &str,
    ) -> Result<Self, BridgeError> {
        let refused = |error: &dyn fmt::Display| BridgeError::Domain(domain, error.to_string());
        let builder = DomainParticipantBuilder::new(domain);
        let builder = match reach {
            Reach::Computer => builder.with_only_networks([Ipv4Addr::LOCALHOST]),
            Reach::Networks => builder,
        };
        let participant = builder.build().map_err(|error| refused(&error))?;
        let any = QosPolicies::qos_none();
        let publisher = participant.create_publisher(&any);
        let subscriber = participant.create_subscriber(&any);
        let publisher = publisher.map_err(|error| refused(&error))?;
        let quality = Quality {
            reliable: true,
            latched: true,
            depth: 1,
        };
        let graph = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";
        let graph = participant.create_topic(
            "ros_discovery_info".to_owned(),
            graph.to_owned(),
            &policies(quality),
            TopicKind::NoKey,
        );
        let graph = graph.map_err(|error| refused(&error))?;
        let graph = publisher.create_datawriter_no_key(&graph, None);
        let graph: Writer = graph.map_err(|error| refused(&error))?;
        Ok(Self {
            statuses: participant.status_listener(),
            subscriber: subscriber.map_err(|error| refused(&error))?,
            publisher,
            readers: Vec::new(),
            writers: vec![graph.guid().to_bytes()],
            graph,
            namespace: if namespace.is_empty() { "/" } else { namespace }.to_owned(),
            name: name.to_owned(),
            carriers: Vec::new(),
            types: BTreeMap::new(),
            next: (0, 0),
            participant,
        })
    }

    fn topic(&mut self, name: String, kind: String, quality: Quality) -> Result<Topic, String> {
        let quality = policies(quality);
        let topic =
            self.participant
                .create_topic(name.clone(), kind.clone(), &quality, TopicKind::NoKey);
        self.types.insert(name, kind);
        topic.map_err(|error| error.to_string())
    }

    fn writer(&mut self, name: String, kind: String, quality: Quality) -> Result<Writer, String> {
        let topic = self.topic(name, kind, quality)?;
        let writer: Result<Writer, _> = self.publisher.create_datawriter_no_key(&topic, None);
        let writer = writer.map_err(|error| error.to_string())?;
        self.writers.push(writer.guid().to_bytes());
        Ok(writer)
    }

    fn reader(&mut self, name: String, kind: String, quality: Quality) -> Result<Reader, String> {
        let topic = self.topic(name, kind, quality)?;
        let reader = self
            .subscriber
            .create_simple_datareader_no_key(&topic, None);
        let reader: Reader = reader.map_err(|error| error.to_string())?;
        self.readers.push(reader.guid().to_bytes());
        Ok(reader)
    }

    fn add(
        &mut self,
        name: &str,
        carrier: Result<Carrier, String>,
    ) -> Result<Channel, BridgeError> {
        let announced = |why: String| BridgeError::Announce(name.to_owned(), why);
        self.carriers.push(carrier.map_err(announced)?);
        self.show(true).map_err(announced)?;
        Ok(self.carriers.len() - 1)
    }

    /// Tells the others what belongs to the node, or that it is gone.
    fn show(&self, is_there: bool) -> Result<(), String> {
        let node = NodeEntities {
            namespace: &self.namespace,
            name: &self.name,
            readers: &self.readers,
            writers: &self.writers,
        };
        let participant = Participant {
            gid: self.participant.guid().to_bytes(),
            nodes: is_there.then_some(node).into_iter().collect(),
        };
        let body = cdr_encoding::to_vec::<_, byteorder::LittleEndian>(&participant);
        let raw = Raw {
            encoding: RepresentationIdentifier::CDR_LE,
            body: body.map_err(|error| error.to_string())?.into(),
        };
        let written = self.graph.write(raw, Some(Timestamp::now()));
        written.map_err(|error| error.to_string())
    }
}

impl Drop for Dds {
    fn drop(&mut self) {
        // Others forget a node that says nothing after some seconds anyway.
        let _ = self.show(false);
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
        let writer = self.writer(format!("rt{name}"), dds_type(of.name, ""), quality);
        self.add(name, writer.map(Carrier::Publication))
    }

    fn publish(&mut self, topic: Channel, data: &[u8]) -> Result<(), BridgeError> {
        let Some(Carrier::Publication(writer)) = self.carriers.get(topic) else {
            return Err(BridgeError::Send(format!("{topic} is no publication")));
        };
        let written = writer.write(body(data), Some(Timestamp::now()));
        written.map_err(|error| BridgeError::Send(error.to_string()))
    }

    fn subscribe(
        &mut self,
        name: &str,
        of: &Definition,
        quality: Quality,
    ) -> Result<Channel, BridgeError> {
        let reader = self.reader(format!("rt{name}"), dds_type(of.name, ""), quality);
        self.add(name, reader.map(Carrier::Subscription))
    }

    fn serve(&mut self, name: &str, of: ServiceType) -> Result<Channel, BridgeError> {
        let (request, reply) = (dds_type(of.0, "_Request"), dds_type(of.0, "_Response"));
        let requests = self.reader(format!("rq{name}Request"), request, SERVICE);
        let answers = self.writer(format!("rr{name}Reply"), reply, SERVICE);
        let carrier = requests.and_then(|requests| {
            let answers = answers?;
            Ok(Carrier::Service { requests, answers })
        });
        self.add(name, carrier)
    }

    fn receive(&mut self) -> Option<Incoming> {
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
        while let Some(status) = self.statuses.try_recv_status() {
            let (endpoint, does) = match status {
                Status::WriterDetected { writer } => (writer, "publishes"),
                Status::ReaderDetected { reader } => (reader, "wants"),
                _ => continue,
            };
            if let (Some(name), Some(kind)) = (
                endpoint.topic_name.strip_prefix("rt"),
                self.types.get(&endpoint.topic_name),
            ) && *kind != endpoint.type_name
            {
                let other = endpoint.type_name;
                return Some(format!(
                    "{name}: somebody {does} {other} there, it is {kind}"
                ));
            }
        }
        None
    }
}
