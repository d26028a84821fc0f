//! A participant of a domain, and the graph of ROS 2: which writers and readers are whose.
//!
//! The nodes of several robots share the participant, as the nodes of one process do in ROS 2.

use super::farewell::{Farewell, multicast};
use super::raw::{AsIs, Raw};
use crate::bridge::{BridgeError, Reach};
use rumbo_ros::topics::Quality;
use rustdds::no_key::{DataWriter, SimpleDataReader};
use rustdds::policy::{Durability, History, Lifespan};
use rustdds::{
    DomainParticipant, DomainParticipantBuilder, DomainParticipantStatusEvent as Status,
    DomainParticipantStatusListener, Duration, Publisher, QosPolicies, QosPolicyBuilder,
    RTPSEntity, RepresentationIdentifier, StatusEvented, Subscriber, Timestamp, Topic, TopicKind,
};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::net::Ipv4Addr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Least time between two publications of the graph; changes in between go together.
const LEAST_INTERVAL: std::time::Duration = std::time::Duration::from_millis(50);
/// RustDDS 0.15.1 loses writers and readers that are made faster than its thread announces them: its queue has room for
/// 512. So there is a rest after so many.
const AT_ONCE: usize = 64;
const REST: std::time::Duration = std::time::Duration::from_millis(20);

pub(super) type Writer = DataWriter<Raw, AsIs>;
pub(super) type Reader = SimpleDataReader<Raw, AsIs>;
type Gid = [u8; 16];

/// `rmw_dds_common/msg/ParticipantEntitiesInfo`, with identities of 16 bytes as Iron and newer have them.
#[derive(Serialize)]
struct Participant<'a> {
    gid: Gid,
    nodes: Vec<NodeEntities<'a>>,
}

#[derive(Serialize)]
struct NodeEntities<'a> {
    namespace: &'a str,
    name: &'a str,
    readers: &'a [Gid],
    writers: &'a [Gid],
}

/// A domain of DDS that is joined, for any number of nodes ([`Dds::new`](super::Dds::new)).
#[derive(Clone)]
pub(crate) struct Domain {
    participant: DomainParticipant,
    publisher: Publisher,
    subscriber: Subscriber,
    graph: Arc<Mutex<Graph>>,
}

/// What is known of the nodes.
struct Graph {
    writer: Writer,
    statuses: DomainParticipantStatusListener,
    /// By namespace and name.
    nodes: BTreeMap<NodeName, Entities>,
    /// When it was published last, and whether it has changed since.
    published: Instant,
    changed: bool,
    /// Writers and readers made.
    made: usize,
    /// Types of the topics used, by name.
    types: BTreeMap<String, String>,
    /// What is wrong with a topic and has not been said yet, by its name.
    troubles: BTreeMap<String, String>,
    /// Why the others may not find these nodes, if it has not been said yet.
    unheard: Option<String>,
    /// After the participant, which is in the listener.
    _farewell: Farewell,
}

/// Namespace (`/`, or `/name`) and name of a node.
pub(super) type NodeName = (String, String);

#[derive(Default)]
struct Entities {
    readers: Vec<Gid>,
    writers: Vec<Gid>,
}

impl fmt::Debug for Domain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "domain {} of DDS", self.participant.domain_id())
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

impl Domain {
    /// Joins a domain.
    ///
    /// # Errors
    /// If there is no such domain, no network, or no free port.
    pub(crate) fn join(domain: u16, reach: Reach) -> Result<Self, BridgeError> {
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
        let topic = participant.create_topic(
            "ros_discovery_info".to_owned(),
            "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_".to_owned(),
            &policies(quality),
            TopicKind::NoKey,
        );
        let topic = topic.map_err(|error| refused(&error))?;
        let writer = publisher.create_datawriter_no_key(&topic, None);
        let graph = Graph {
            writer: writer.map_err(|error| refused(&error))?,
            statuses: participant.status_listener(),
            nodes: BTreeMap::new(),
            published: Instant::now(),
            changed: false,
            made: 0,
            types: BTreeMap::new(),
            troubles: BTreeMap::new(),
            unheard: multicast(reach).err().map(|error| {
                format!("no multicast here ({error}): other nodes do not find this one; is the network up?")
            }),
            _farewell: Farewell {
                participant: participant.guid(),
                domain,
                reach,
            },
        };
        Ok(Self {
            subscriber: subscriber.map_err(|error| refused(&error))?,
            publisher,
            graph: Arc::new(Mutex::new(graph)),
            participant,
        })
    }

    /// The graph holds whatever a thread did that has panicked.
    fn graph(&self) -> MutexGuard<'_, Graph> {
        self.graph.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn add(&self, node: &NodeName) {
        let mut graph = self.graph();
        graph.nodes.entry(node.clone()).or_default();
        graph.changed = true;
    }

    /// Takes a node off the graph.
    pub(super) fn remove(&self, node: &NodeName) {
        let mut graph = self.graph();
        graph.nodes.remove(node);
        let _ = graph.tell(&self.participant);
    }

    /// Tells the others what has changed, if that is due.
    pub(super) fn tell(&self) -> Result<(), String> {
        let mut graph = self.graph();
        match graph.changed && graph.published.elapsed() >= LEAST_INTERVAL {
            true => graph.tell(&self.participant),
            false => Ok(()),
        }
    }

    fn topic(&self, name: String, kind: String, quality: Quality) -> Result<Topic, String> {
        let quality = policies(quality);
        let topic =
            self.participant
                .create_topic(name.clone(), kind.clone(), &quality, TopicKind::NoKey);
        self.graph().types.insert(name, kind);
        topic.map_err(|error| error.to_string())
    }

    /// Notes what a node has got.
    fn made(&self, of: &NodeName, note: impl FnOnce(&mut Entities)) {
        let mut graph = self.graph();
        note(graph.nodes.entry(of.clone()).or_default());
        graph.changed = true;
        graph.made += 1;
        let rests = graph.made.is_multiple_of(AT_ONCE);
        drop(graph);
        if rests {
            std::thread::sleep(REST);
        }
    }

    pub(super) fn writer(
        &self,
        of: &NodeName,
        name: String,
        kind: String,
        quality: Quality,
    ) -> Result<Writer, String> {
        let topic = self.topic(name, kind, quality)?;
        let writer: Result<Writer, _> = self.publisher.create_datawriter_no_key(&topic, None);
        let writer = writer.map_err(|error| error.to_string())?;
        let gid = writer.guid().to_bytes();
        self.made(of, |entities| entities.writers.push(gid));
        Ok(writer)
    }

    pub(super) fn reader(
        &self,
        of: &NodeName,
        name: String,
        kind: String,
        quality: Quality,
    ) -> Result<Reader, String> {
        let topic = self.topic(name, kind, quality)?;
        let reader = self
            .subscriber
            .create_simple_datareader_no_key(&topic, None);
        let reader: Reader = reader.map_err(|error| error.to_string())?;
        let gid = reader.guid().to_bytes();
        self.made(of, |entities| entities.readers.push(gid));
        Ok(reader)
    }

    /// What is wrong with the network or one of these topics, once.
    pub(super) fn trouble(&self, topics: &[String]) -> Option<String> {
        let mut graph = self.graph();
        graph.hear();
        let unheard = graph.unheard.take();
        unheard.or_else(|| topics.iter().find_map(|name| graph.troubles.remove(name)))
    }
}

impl Graph {
    fn tell(&mut self, participant: &DomainParticipant) -> Result<(), String> {
        self.published = Instant::now();
        let nodes = self.nodes.iter();
        let nodes = nodes.map(|((namespace, name), of)| NodeEntities {
            namespace,
            name,
            readers: &of.readers,
            writers: &of.writers,
        });
        let participant = Participant {
            gid: participant.guid().to_bytes(),
            nodes: nodes.collect(),
        };
        let body = cdr_encoding::to_vec::<_, byteorder::LittleEndian>(&participant);
        let raw = Raw {
            encoding: RepresentationIdentifier::CDR_LE,
            body: body.map_err(|error| error.to_string())?.into(),
        };
        let written = self.writer.write(raw, Some(Timestamp::now()));
        written.map_err(|error| error.to_string())?;
        self.changed = false;
        Ok(())
    }

    /// Takes what is new of the others.
    fn hear(&mut self) {
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
                let trouble = format!("{name}: somebody {does} {other} there, it is {kind}");
                self.troubles.insert(endpoint.topic_name, trouble);
            }
        }
    }
}
