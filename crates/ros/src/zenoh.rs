//! The bridge over Zenoh, as `rmw_zenoh_cpp` of ROS 2 speaks it.
//!
//! ```text
//! topic /odom            a publisher on its key; of a latched one the last message, for those who ask for it
//! service /rumbo/arm     a queryable on its key: a request is a query, an answer its reply
//! the node               a liveliness token, and one for each topic and service
//! ```
//!
//! Keys, tokens and what is attached to data: [`token`]. The sources are `docs/design.md` and `liveliness_utils.cpp` of
//! `rmw_zenoh`. What latched messages are asked by is that of `zenoh-ext`'s advanced publishers and subscribers:
//! `KEY/@adv/pub/SESSION/uhlc/_`, a token and a queryable.

mod session;
mod token;

pub use session::{Endpoint, Session};

use crate::bridge::{Bridge, BridgeError, Caller, Channel, Incoming, ServiceType};
use crate::topics::Quality;
use crate::types::Definition;
use std::collections::VecDeque;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};
use token::{Attached, Kind, NodeName, Subject, identity};
use zenoh::Wait;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::{Publisher, Subscriber};
use zenoh::qos::CongestionControl;
use zenoh::query::{Query, Queryable};
use zenoh::sample::Sample;
use zenoh::time::Timestamp;

/// Requests kept.
const SERVICE: Quality = Quality {
    reliable: true,
    latched: false,
    depth: 10,
};
/// Requests that wait for an answer; the oldest one gets none.
const MOST_WAITING: usize = 256;

/// What came in on a channel and was not taken yet, and the requests of it by who asks.
type Arrived<T> = Arc<Mutex<VecDeque<T>>>;

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps the newest of what came in.
fn keep<T>(arrived: &Mutex<VecDeque<T>>, newest: T, depth: i32) {
    let mut arrived = lock(arrived);
    arrived.push_back(newest);
    let most = usize::try_from(depth).unwrap_or(1).max(1);
    while arrived.len() > most {
        arrived.pop_front();
    }
}

/// A message as it was published last: what came with it and when.
#[derive(Clone)]
struct Last {
    data: Vec<u8>,
    attached: Vec<u8>,
    at: Timestamp,
}

/// What a channel is. What is not read any more is there as long as it is announced.
enum Carrier {
    Publication {
        publisher: Publisher<'static>,
        identity: [u8; 16],
        /// Counts its messages.
        number: i64,
        latched: Option<Latched>,
    },
    Subscription {
        arrived: Arrived<Incoming>,
        _subscriber: Subscriber<()>,
    },
    Service {
        arrived: Arrived<Query>,
        _queryable: Queryable<()>,
    },
}

/// The last message of a publisher, for those who come late.
struct Latched {
    last: Arc<Mutex<Option<Last>>>,
    _queryable: Queryable<()>,
    _token: LivelinessToken,
}

/// A node on Zenoh. Dropping it takes it off the graph.
pub struct Zenoh {
    session: Session,
    node: NodeName,
    /// Names of the topics and services used.
    names: Vec<String>,
    carriers: Vec<Carrier>,
    tokens: Vec<LivelinessToken>,
    /// Where the next message is looked for.
    next: usize,
    /// Requests without an answer yet.
    waiting: VecDeque<(Caller, Query)>,
}

impl fmt::Debug for Zenoh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let NodeName {
            namespace, name, ..
        } = &self.node;
        write!(f, "{name} in {namespace} on {:?}", self.session)
    }
}

/// Nanoseconds since 1970.
fn now_ns() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    i64::try_from(since.unwrap_or_default().as_nanos()).unwrap_or(i64::MAX)
}

/// What comes in on a subscription. A sender that attaches nothing is accepted too.
fn message(channel: Channel, sample: &Sample) -> Incoming {
    let attached = sample.attachment();
    let attached = attached.and_then(|attached| Attached::read(&attached.to_bytes()));
    Incoming::Message {
        channel,
        sender: attached.map_or([0; 16], |attached| attached.identity),
        age_s: attached.map(|attached| (now_ns().saturating_sub(attached.time_ns)) as f64 / 1e9),
        data: sample.payload().to_bytes().into_owned(),
    }
}

/// Who sends a request; `None`: it does not say, so that nobody can be answered.
fn caller(service: Channel, query: &Query) -> Option<Caller> {
    let attached = Attached::read(&query.attachment()?.to_bytes())?;
    Some(Caller {
        service,
        client: attached.identity,
        number: attached.number,
    })
}

impl Zenoh {
    /// The node of this name in a namespace (empty, or `/name`).
    ///
    /// # Errors
    /// If it cannot be announced.
    pub fn new(session: &Session, namespace: &str, name: &str) -> Result<Self, BridgeError> {
        let node = NodeName {
            domain: session.domain,
            session: session.session.zid().to_string(),
            number: session.number(),
            namespace: if namespace.is_empty() { "/" } else { namespace }.to_owned(),
            name: name.to_owned(),
        };
        let mut made = Self {
            session: session.clone(),
            names: Vec::new(),
            carriers: Vec::new(),
            tokens: Vec::new(),
            next: 0,
            waiting: VecDeque::new(),
            node,
        };
        let token = made.node.token();
        let announced = made.announce(&token);
        announced.map_err(|error| BridgeError::Announce(name.to_owned(), error.to_string()))?;
        Ok(made)
    }

    fn announce(&mut self, token: &str) -> zenoh::Result<()> {
        let liveliness = self.session.session.liveliness();
        let token = liveliness.declare_token(token.to_owned()).wait()?;
        self.tokens.push(token);
        Ok(())
    }

    /// Makes a channel, and the token that announces it.
    fn add(
        &mut self,
        kind: Kind,
        of: &Subject,
        quality: Quality,
        make: impl FnOnce(&Self, String, &str) -> zenoh::Result<Carrier>,
    ) -> Result<Channel, BridgeError> {
        let token = self
            .node
            .entity_token(self.session.number(), kind, of, quality);
        self.session.uses(&of.name, &of.kind, &of.hash);
        self.names.push(of.name.clone());
        let made = make(self, of.key(self.node.domain), &token);
        let made = made.and_then(|carrier| self.announce(&token).map(|()| carrier));
        let made = made.map_err(|error| BridgeError::Announce(of.name.clone(), error.to_string()));
        self.carriers.push(made?);
        Ok(self.carriers.len() - 1)
    }

    /// Keeps the last message of a key for those who come late.
    fn latch(&self, key: &str) -> zenoh::Result<Latched> {
        let session = &self.session.session;
        let place = format!("{key}/@adv/pub/{}/uhlc/_", session.zid());
        let last: Arc<Mutex<Option<Last>>> = Arc::default();
        let (kept, key) = (Arc::clone(&last), key.to_owned());
        let answer = move |query: Query| {
            let kept = lock(&kept).clone();
            if let Some(Last { data, attached, at }) = kept {
                let reply = query.reply(key.clone(), data).attachment(attached);
                // One who has gone meanwhile needs none.
                let _ = reply.timestamp(at).wait();
            }
        };
        let queryable = session.declare_queryable(place.clone()).callback(answer);
        Ok(Latched {
            last,
            _queryable: queryable.wait()?,
            _token: session.liveliness().declare_token(place).wait()?,
        })
    }
}

impl Bridge for Zenoh {
    fn advertise(
        &mut self,
        name: &str,
        of: &Definition,
        quality: Quality,
    ) -> Result<Channel, BridgeError> {
        let subject = Subject::topic(name, of);
        self.add(Kind::Publisher, &subject, quality, |node, key, token| {
            let publisher = node.session.session.declare_publisher(key.clone());
            // Who reads too slowly loses messages, and is not waited for.
            let publisher = publisher.congestion_control(CongestionControl::Drop);
            Ok(Carrier::Publication {
                publisher: publisher.wait()?,
                identity: identity(token),
                number: 0,
                latched: quality.latched.then(|| node.latch(&key)).transpose()?,
            })
        })
    }

    fn publish(&mut self, topic: Channel, data: &[u8]) -> Result<(), BridgeError> {
        let Some(Carrier::Publication {
            publisher,
            identity,
            number,
            latched,
        }) = self.carriers.get_mut(topic)
        else {
            return Err(BridgeError::Send(format!("{topic} is no publication")));
        };
        *number += 1;
        let attached = Attached {
            number: *number,
            time_ns: now_ns(),
            identity: *identity,
        };
        let attached = attached.to_bytes();
        let at = self.session.session.new_timestamp();
        if let Some(latched) = latched {
            *lock(&latched.last) = Some(Last {
                data: data.to_vec(),
                attached: attached.clone(),
                at,
            });
        }
        let sent = publisher.put(data).attachment(attached).timestamp(at);
        sent.wait()
            .map_err(|error| BridgeError::Send(error.to_string()))
    }

    fn subscribe(
        &mut self,
        name: &str,
        of: &Definition,
        quality: Quality,
    ) -> Result<Channel, BridgeError> {
        let subject = Subject::topic(name, of);
        let channel = self.carriers.len();
        self.add(Kind::Subscription, &subject, quality, |node, key, _| {
            let arrived: Arrived<Incoming> = Arc::default();
            let into = Arc::clone(&arrived);
            let take = move |sample: Sample| keep(&into, message(channel, &sample), quality.depth);
            let subscriber = node.session.session.declare_subscriber(key).callback(take);
            Ok(Carrier::Subscription {
                arrived,
                _subscriber: subscriber.wait()?,
            })
        })
    }

    fn serve(&mut self, name: &str, of: ServiceType) -> Result<Channel, BridgeError> {
        let subject = Subject::service(name, of);
        self.add(Kind::Service, &subject, SERVICE, |node, key, _| {
            let arrived: Arrived<Query> = Arc::default();
            let into = Arc::clone(&arrived);
            let queryable = node.session.session.declare_queryable(key).complete(true);
            let queryable = queryable.callback(move |query| keep(&into, query, SERVICE.depth));
            Ok(Carrier::Service {
                arrived,
                _queryable: queryable.wait()?,
            })
        })
    }

    fn receive(&mut self) -> Option<Incoming> {
        for _ in 0..self.carriers.len() {
            let channel = self.next;
            self.next = (channel + 1) % self.carriers.len();
            match self.carriers.get(channel) {
                Some(Carrier::Subscription { arrived, .. }) => {
                    if let Some(incoming) = lock(arrived).pop_front() {
                        return Some(incoming);
                    }
                }
                Some(Carrier::Service { arrived, .. }) => {
                    let Some(query) = lock(arrived).pop_front() else {
                        continue;
                    };
                    let Some(caller) = caller(channel, &query) else {
                        continue;
                    };
                    let data = query.payload();
                    let data = data.map_or_else(Vec::new, |data| data.to_bytes().into_owned());
                    self.waiting.push_back((caller, query));
                    if self.waiting.len() > MOST_WAITING {
                        self.waiting.pop_front();
                    }
                    return Some(Incoming::Request { caller, data });
                }
                Some(Carrier::Publication { .. }) | None => {}
            }
        }
        None
    }

    fn answer(&mut self, caller: Caller, data: &[u8]) -> Result<(), BridgeError> {
        let is_it = |(who, _): &(Caller, Query)| *who == caller;
        let place = self.waiting.iter().position(is_it);
        let Some((_, query)) = place.and_then(|place| self.waiting.remove(place)) else {
            // It has waited too long.
            return Ok(());
        };
        let attached = Attached {
            number: caller.number,
            time_ns: now_ns(),
            identity: caller.client,
        };
        let reply = query.reply(query.key_expr().clone(), data);
        let sent = reply.attachment(attached.to_bytes()).wait();
        sent.map_err(|error| BridgeError::Send(error.to_string()))
    }

    fn trouble(&mut self) -> Option<String> {
        self.session.trouble(&self.names)
    }
}
