//! What a node asks of a middleware: to publish, to subscribe, to serve. All data are bytes in CDR with their header of
//! four bytes, as [`encode`](rumbo_ros::types::encode) makes them.

use rumbo_ros::topics::Quality;
use rumbo_ros::types::Definition;
use thiserror::Error;

/// Something a bridge carries, numbered by the bridge.
pub(crate) type Channel = usize;

/// Who asked a service, by the bridge's own account; the answer goes there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Caller {
    /// The service.
    pub(crate) service: Channel,
    /// The client, 16 bytes that are its own.
    pub(crate) client: [u8; 16],
    /// Its request.
    pub(crate) number: i64,
}

/// What has come in.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Incoming {
    /// A message of a subscription.
    Message {
        /// The subscription.
        channel: Channel,
        /// The publisher, by the bridge's own account.
        sender: [u8; 16],
        /// Time since it was sent, by the clocks of both computers \[s\]; `None`: the sender does not say.
        age_s: Option<f64>,
        /// The message.
        data: Vec<u8>,
    },
    /// A request to a service.
    Request {
        /// Who asks.
        caller: Caller,
        /// The request.
        data: Vec<u8>,
    },
}

/// Who may find the nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reach {
    /// This computer. No wall: they are only not announced elsewhere.
    Computer,
    /// All networks that this computer is in.
    Networks,
}

/// A middleware with one node on it. Names are absolute: `/odom`.
pub(crate) trait Bridge {
    /// Announces a topic to publish on.
    ///
    /// # Errors
    /// If the middleware refuses.
    fn advertise(
        &mut self,
        name: &str,
        of: &Definition,
        quality: Quality,
    ) -> Result<Channel, BridgeError>;

    /// Publishes a message on a topic that was announced. Never waits for a reader.
    ///
    /// # Errors
    /// If the middleware refuses.
    fn publish(&mut self, topic: Channel, data: &[u8]) -> Result<(), BridgeError>;

    /// Subscribes to a topic.
    ///
    /// # Errors
    /// If the middleware refuses.
    fn subscribe(
        &mut self,
        name: &str,
        of: &Definition,
        quality: Quality,
    ) -> Result<Channel, BridgeError>;

    /// Offers a service of this type, by package and name: `std_srvs/srv/Trigger`.
    ///
    /// # Errors
    /// If the middleware refuses.
    fn serve(&mut self, name: &str, kind: &str) -> Result<Channel, BridgeError>;

    /// The next message or request, without waiting.
    fn receive(&mut self) -> Option<Incoming>;

    /// Answers a request.
    ///
    /// # Errors
    /// If the middleware refuses.
    fn answer(&mut self, caller: Caller, data: &[u8]) -> Result<(), BridgeError>;

    /// What a person should know of the others since the last call: one who uses a name of ours with another type.
    fn trouble(&mut self) -> Option<String>;
}

/// Why a middleware refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub(crate) enum BridgeError {
    /// The domain cannot be joined: which, and why.
    #[error(
        "domain {0} of ROS 2 cannot be joined ({1}); is a network up, and are its ports free? --domain takes \
         another"
    )]
    Domain(u16, String),
    /// A topic or service cannot be announced: which, and why.
    #[error("{0} cannot be announced: {1}")]
    Announce(String, String),
    /// Something cannot be sent: why.
    #[error("nothing can be sent: {0}")]
    Send(String),
}
