//! A live session for viewers of Foxglove's protocol (Foxglove, Lichtblick): the messages of the log, as they are made.
//!
//! Read-only: messages from viewers are ignored. Only this machine can connect. The bridge gets the entries that are
//! recorded; a thread encodes them for the topics that have subscribers. A slow viewer loses messages and delays
//! nobody.

use foxglove::{ChannelBuilder, Context, FoxgloveError, PartialMetadata, RawChannel, Schema};
use foxglove::{WebSocketServer, WebSocketServerHandle};
use rumbo_log::{Entry, Sink, Topic};
use std::convert::Infallible;
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use std::{fmt, io};

/// The port that viewers try first.
pub const BRIDGE_PORT: u16 = 8_765;
/// Longest queue of entries.
const QUEUE: usize = 1_024;
/// Longest queue of messages for one viewer.
const BACKLOG: usize = 1_024;
/// Scene and parameters are republished this often, for viewers that connect later.
const REPUBLISH: Duration = Duration::from_secs(1);

/// Why the bridge cannot be started.
#[derive(Debug)]
pub enum BridgeError {
    /// It cannot be served on this port.
    Port(u16, FoxgloveError),
    /// No thread can be started for it.
    Thread(io::Error),
}

impl fmt::Display for BridgeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Port(port, error) => write!(
                f,
                "the bridge cannot be served on 127.0.0.1:{port} ({error}); choose another port with --foxglove"
            ),
            Self::Thread(error) => write!(f, "the bridge cannot be started: {error}"),
        }
    }
}

impl std::error::Error for BridgeError {}

/// The bridge; dropping it ends it.
pub struct Bridge {
    /// Joins channels and server, which do not keep it alive.
    _context: Arc<Context>,
    server: Option<WebSocketServerHandle>,
    entries: Option<SyncSender<Arc<Entry>>>,
    thread: Option<JoinHandle<()>>,
    port: u16,
}

impl Bridge {
    /// Serves on this port of 127.0.0.1; 0 takes any free one. It blocks: do not call it in an asynchronous task.
    ///
    /// # Errors
    /// If the port is not available, or no thread can be started.
    pub fn start(port: u16) -> Result<Self, BridgeError> {
        let failed = |error| BridgeError::Port(port, error);
        let context = Context::new();
        let channels = Topic::ALL.map(|topic| channel(&context, topic));
        let channels = channels
            .into_iter()
            .collect::<Result<Vec<_>, _>>()
            .map_err(failed)?;
        let server = WebSocketServer::new()
            .name("rumbo")
            .context(&context)
            .message_backlog_size(BACKLOG)
            .bind(Ipv4Addr::LOCALHOST.to_string(), port)
            .start_blocking()
            .map_err(failed)?;
        let (entries, taken) = sync_channel(QUEUE);
        let thread = std::thread::Builder::new()
            .name("bridge".into())
            .spawn(move || publish(&Channels(channels), &taken))
            .map_err(BridgeError::Thread)?;
        Ok(Self {
            _context: context,
            port: server.port(),
            server: Some(server),
            entries: Some(entries),
            thread: Some(thread),
        })
    }

    /// The address for viewers.
    #[must_use]
    pub fn address(&self) -> String {
        format!("ws://127.0.0.1:{}", self.port)
    }

    /// Queues an entry; it is dropped if the queue is full.
    pub(crate) fn queue(&self, entry: &Arc<Entry>) {
        if let Some(entries) = &self.entries {
            let _ = entries.try_send(Arc::clone(entry));
        }
    }
}

impl fmt::Debug for Bridge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Bridge at {}", self.address())
    }
}

impl Drop for Bridge {
    fn drop(&mut self) {
        drop(self.entries.take());
        if let Some(server) = self.server.take() {
            drop(server.stop());
        }
        let ended = self.thread.take().map(JoinHandle::join);
        drop(ended);
    }
}

fn channel(context: &Arc<Context>, topic: Topic) -> Result<Arc<RawChannel>, FoxgloveError> {
    let (name, schema) = topic.schema();
    ChannelBuilder::new(topic.name())
        .context(context)
        .message_encoding("json")
        .schema(Schema::new(
            name,
            "jsonschema",
            schema.to_string().into_bytes(),
        ))
        .build_raw()
}

/// The topics, in the order of their numbers.
struct Channels(Vec<Arc<RawChannel>>);

impl Sink for &Channels {
    type Error = Infallible;

    fn put(&mut self, topic: Topic, t_us: u64, data: &[u8]) -> Result<(), Infallible> {
        if let Some(channel) = self.0.get(topic as usize) {
            let log_time = Some(t_us.saturating_mul(1_000));
            channel.log_with_meta(data, PartialMetadata { log_time });
        }
        Ok(())
    }
}

/// Publishes entries to the viewers until the bridge is dropped.
fn publish(channels: &Channels, entries: &Receiver<Arc<Entry>>) {
    let (mut scene, mut parameters) = (None, None);
    let (mut now_us, mut again) = (0, Instant::now() + REPUBLISH);
    let mut sink = channels;
    while let Ok(entry) = entries.recv() {
        match &*entry {
            Entry::Scene(_) => scene = Some(Arc::clone(&entry)),
            Entry::Parameters(_) => parameters = Some(Arc::clone(&entry)),
            _ => {}
        }
        if !channels.0.iter().any(|channel| channel.has_sinks()) {
            continue;
        }
        let Ok(()) = sink.entry(&entry, &mut now_us);
        if Instant::now() >= again {
            again = Instant::now() + REPUBLISH;
            for entry in [&scene, &parameters].into_iter().flatten() {
                let Ok(()) = sink.entry(entry, &mut now_us);
            }
        }
    }
}
