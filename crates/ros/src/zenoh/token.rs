//! What others know a node by on Zenoh: keys of topics and services, liveliness tokens, and what is attached to data.
//!
//! ```text
//! 0/odom/nav_msgs::msg::dds_::Odometry_/RIHS01_…                              a topic of domain 0, or a service
//! @ros2_lv/0/SESSION/NODE/NODE/NN/%/%first/rumbo                              a node, in the namespace /first
//! @ros2_lv/0/SESSION/NODE/NUMBER/MP/%/%/rumbo/%odom/TYPE/HASH/::,10:,:,:,,    a publisher
//! 33 bytes: i64 number, i64 time since 1970 [ns], 16, identity                beside each message
//! ```
//!
//! A slash within a part is written `%`. Of the quality of service what is the default of `rmw_zenoh_cpp` is left out.

use crate::bridge::ServiceType;
use crate::topics::Quality;
use crate::types::{Definition, dds_type};
use twox_hash::XxHash3_128;

/// What a token stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Publisher,
    Subscription,
    Service,
}

impl Kind {
    fn code(self) -> &'static str {
        match self {
            Self::Publisher => "MP",
            Self::Subscription => "MS",
            Self::Service => "SS",
        }
    }
}

/// A node, as its tokens name it.
#[derive(Clone, Debug)]
pub(super) struct NodeName {
    pub(super) domain: u16,
    pub(super) session: String,
    pub(super) number: usize,
    /// `/`, or `/name`.
    pub(super) namespace: String,
    pub(super) name: String,
}

/// A topic or service: name, type as DDS has it, hash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Subject {
    pub(super) name: String,
    pub(super) kind: String,
    pub(super) hash: String,
}

impl Subject {
    /// A topic.
    pub(super) fn topic(name: &str, of: &Definition) -> Self {
        Self {
            name: name.to_owned(),
            kind: dds_type(of.name, ""),
            hash: of.hash(),
        }
    }

    /// A service.
    pub(super) fn service(name: &str, of: ServiceType) -> Self {
        Self {
            name: name.to_owned(),
            kind: dds_type(of.name, ""),
            hash: of.hash.to_owned(),
        }
    }

    /// The key of its data.
    pub(super) fn key(&self, domain: u16) -> String {
        let name = self.name.trim_start_matches('/');
        format!("{domain}/{name}/{}/{}", self.kind, self.hash)
    }
}

/// All tokens of a domain.
pub(super) fn all_tokens(domain: u16) -> String {
    format!("@ros2_lv/{domain}/**")
}

impl NodeName {
    fn token_of(&self, number: usize, code: &str) -> String {
        let Self {
            domain,
            session,
            number: node,
            namespace,
            name,
        } = self;
        let namespace = namespace.replace('/', "%");
        format!("@ros2_lv/{domain}/{session}/{node}/{number}/{code}/%/{namespace}/{name}")
    }

    /// The token of the node itself.
    pub(super) fn token(&self) -> String {
        self.token_of(self.number, "NN")
    }

    /// The token of something that it has.
    pub(super) fn entity_token(
        &self,
        number: usize,
        kind: Kind,
        of: &Subject,
        quality: Quality,
    ) -> String {
        let node = self.token_of(number, kind.code());
        let Subject { name, kind, hash } = of;
        let name = name.replace('/', "%");
        // Numbers of `rmw`: 2 best effort, 1 transient local.
        let reliability = if quality.reliable { "" } else { "2" };
        let durability = if quality.latched { "1" } else { "" };
        let depth = quality.depth;
        format!("{node}/{name}/{kind}/{hash}/{reliability}:{durability}:,{depth}:,:,:,,")
    }
}

/// What a token says of a topic or service: what its owner does, and with what. `None`: it is none, or a node's.
pub(super) fn read_token(token: &str) -> Option<(&'static str, Subject)> {
    let parts: Vec<&str> = token.split('/').collect();
    let ["@ros2_lv", _, _, _, _, code, _, _, _, name, kind, hash, _] = parts[..] else {
        return None;
    };
    let does = match code {
        "MP" => "publishes",
        "MS" => "wants",
        "SS" => "serves",
        "SC" => "calls",
        _ => return None,
    };
    let subject = Subject {
        name: name.replace('%', "/"),
        kind: kind.to_owned(),
        hash: hash.to_owned(),
    };
    Some((does, subject))
}

/// The identity of what a token stands for.
pub(super) fn identity(token: &str) -> [u8; 16] {
    XxHash3_128::oneshot(token.as_bytes()).to_le_bytes()
}

/// What is attached to data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Attached {
    /// Counts the messages of a publisher, or the requests of a client.
    pub(super) number: i64,
    /// Since 1970 \[ns\].
    pub(super) time_ns: i64,
    /// Publisher or client.
    pub(super) identity: [u8; 16],
}

impl Attached {
    pub(super) fn to_bytes(self) -> Vec<u8> {
        let Self {
            number,
            time_ns,
            identity,
        } = self;
        let length = [identity.len() as u8];
        [
            &number.to_le_bytes()[..],
            &time_ns.to_le_bytes(),
            &length,
            &identity,
        ]
        .concat()
    }

    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        let (number, rest) = bytes.split_first_chunk()?;
        let (time_ns, rest) = rest.split_first_chunk()?;
        let (16, identity) = rest.split_first().map(|(length, rest)| (*length, rest))? else {
            return None;
        };
        Some(Self {
            number: i64::from_le_bytes(*number),
            time_ns: i64::from_le_bytes(*time_ns),
            identity: identity.try_into().ok()?,
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn subject() -> Subject {
        Subject {
            name: "/first/cmd_vel".into(),
            kind: "geometry_msgs::msg::dds_::Twist_".into(),
            hash: "RIHS01_0".into(),
        }
    }

    #[test]
    fn a_token_names_the_node_and_what_it_has() {
        let node = NodeName {
            domain: 7,
            session: "a1".into(),
            number: 0,
            namespace: "/first".into(),
            name: "rumbo".into(),
        };
        assert_eq!(node.token(), "@ros2_lv/7/a1/0/0/NN/%/%first/rumbo");
        assert_eq!(read_token(&node.token()), None);
        let quality = Quality {
            reliable: false,
            latched: true,
            depth: 1,
        };
        let token = node.entity_token(3, Kind::Subscription, &subject(), quality);
        assert_eq!(
            token,
            "@ros2_lv/7/a1/0/3/MS/%/%first/rumbo/%first%cmd_vel/geometry_msgs::msg::dds_::Twist_/RIHS01_0/2:1:,1:,:,:,,"
        );
        assert_eq!(read_token(&token), Some(("wants", subject())));
        assert_eq!(
            subject().key(7),
            "7/first/cmd_vel/geometry_msgs::msg::dds_::Twist_/RIHS01_0"
        );
    }

    #[test]
    fn what_is_no_token_says_nothing() {
        for garbage in [
            "",
            "@ros2_lv",
            "@ros2_lv/0/a/0/1/XX/%/%/n/%t/k/h/q",
            "a/b/c/d/e/MP/g/h/i/j/k/l/m",
        ] {
            assert_eq!(read_token(garbage), None, "{garbage}");
        }
    }

    #[test]
    fn an_attachment_is_read_as_it_was_written_and_nothing_else_is() {
        let attached = Attached {
            number: 5,
            time_ns: -1,
            identity: [9; 16],
        };
        let bytes = attached.to_bytes();
        assert_eq!(bytes.len(), 33);
        assert_eq!(Attached::read(&bytes), Some(attached));
        for length in 0..33 {
            assert_eq!(Attached::read(&bytes[..length]), None);
        }
        assert_eq!(Attached::read(&[&bytes[..], &[0]].concat()), None);
        let other = [&bytes[..16], &[15], &bytes[17..]].concat();
        assert_eq!(Attached::read(&other), None);
    }
}
