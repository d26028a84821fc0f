//! Who may use the dashboard: anyone who has the printed address, and no website.
//!
//! Any website can make the browser send requests to 127.0.0.1, and with a DNS name that resolves there it can read the
//! answers (DNS rebinding). So every request must name exactly this host, and must come from this origin if it comes
//! from a page. The page itself is no secret. Its WebSocket shows and drives the robot, and requires a key, which the
//! page gets in exchange for the token in a printed address. There are two addresses: the controller's works once, so
//! that one seen over a shoulder is worthless, and who sits at the terminal gets another one; the viewers' works for
//! everyone who has it, to watch and to stop the robot. A program of the same user gets the key itself, in a file that
//! nobody else can read.
//!
//! The key is no cookie: a browser sends cookies to every port of a host, and other users of this computer may run
//! servers there. The page keeps it in its storage, which belongs to this port alone.

use crate::error::ServeError;
use axum::http::{HeaderMap, header};
use std::net::{IpAddr, SocketAddr};
use std::sync::mpsc::Sender;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use subtle::ConstantTimeEq;

/// A random secret of 256 bits, in hexadecimal.
#[derive(Debug)]
pub(crate) struct Secret(pub(crate) String);

impl Secret {
    pub(crate) fn new() -> Result<Self, getrandom::Error> {
        let mut bytes = [0u8; 32];
        getrandom::fill(&mut bytes)?;
        Ok(Self(
            bytes.iter().map(|byte| format!("{byte:02x}")).collect(),
        ))
    }

    /// Compares in constant time.
    fn matches(&self, offered: &str) -> bool {
        self.0.as_bytes().ct_eq(offered.as_bytes()).into()
    }
}

/// What the owner of a key may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Role {
    /// Watch, and stop the robot.
    Viewer,
    /// Everything, while nobody else has control.
    Controller,
}

/// Token and key of a role.
#[derive(Debug)]
struct Access {
    role: Role,
    token: Secret,
    key: Secret,
}

impl Access {
    fn new(role: Role) -> Result<Self, getrandom::Error> {
        Ok(Self {
            role,
            token: Secret::new()?,
            key: Secret::new()?,
        })
    }

    /// The name of the token in the address.
    fn parameter(&self) -> &'static str {
        match self.role {
            Role::Controller => "token",
            Role::Viewer => "watch",
        }
    }
}

/// A further token, and what the page presented that used it.
#[derive(Debug)]
struct Entry {
    token: Secret,
    used_by: OnceLock<String>,
}

/// Decides on requests.
#[derive(Debug)]
pub(crate) struct Guard {
    at: SocketAddr,
    hosts: Vec<String>,
    origins: Vec<String>,
    controller: Access,
    viewer: Access,
    /// Further tokens of the controller, for addresses that were asked for.
    further: Mutex<Vec<Entry>>,
    /// What the page that used the controller's token presented: it asks again if the answer is lost.
    used_by: OnceLock<String>,
    /// Notified then.
    opened: Sender<()>,
}

/// Why a request is turned away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Denied {
    /// It names another host.
    Host,
    /// It comes from a page of another origin, or from no page where one is needed.
    Origin,
    /// It carries no valid key.
    Key,
    /// Its token is wrong or was used already.
    Token,
}

impl Denied {
    /// The text for the person.
    pub(crate) fn explanation(self) -> &'static str {
        match self {
            Self::Host => {
                "refused: this address is not the dashboard's; open the one that rumbo printed"
            }
            Self::Origin => "refused: only the dashboard's own page may talk to the robot",
            Self::Key => {
                "refused: open the address that rumbo printed when it started, with its token"
            }
            Self::Token => {
                "refused: this address was used already or is of an earlier start; use the browser in which it was opened, or press Enter where rumbo runs: it prints another address"
            }
        }
    }
}

impl Guard {
    /// A guard for the dashboard at this address; it reports when the controller's address has been opened.
    ///
    /// # Errors
    /// When the system gives no randomness.
    pub(crate) fn new(at: SocketAddr, opened: Sender<()>) -> Result<Self, getrandom::Error> {
        let mut hosts = vec![at.to_string()];
        if at.ip().is_loopback() {
            hosts.push(format!("localhost:{}", at.port()));
        }
        Ok(Self {
            at,
            origins: hosts.iter().map(|host| format!("http://{host}")).collect(),
            hosts,
            controller: Access::new(Role::Controller)?,
            viewer: Access::new(Role::Viewer)?,
            further: Mutex::default(),
            used_by: OnceLock::new(),
            opened,
        })
    }

    /// Another address to open, once, as in another browser.
    ///
    /// # Errors
    /// When the system gives no randomness.
    pub(crate) fn another_url(&self) -> Result<String, getrandom::Error> {
        let token = Secret::new()?;
        let url = format!("http://{}/?token={}", self.at, token.0);
        let used_by = OnceLock::new();
        self.further().push(Entry { token, used_by });
        Ok(url)
    }

    fn further(&self) -> MutexGuard<'_, Vec<Entry>> {
        self.further.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The address to open, once.
    pub(crate) fn url(&self) -> String {
        self.address_of(&self.controller)
    }

    /// The address for viewers.
    pub(crate) fn viewers_url(&self) -> String {
        self.address_of(&self.viewer)
    }

    /// The key of those who may drive.
    pub(crate) fn drivers_key(&self) -> &str {
        &self.controller.key.0
    }

    fn address_of(&self, access: &Access) -> String {
        let Secret(token) = &access.token;
        format!("http://{}/?{}={token}", self.at, access.parameter())
    }

    fn accesses(&self) -> [&Access; 2] {
        [&self.controller, &self.viewer]
    }

    /// Host and origin are ours. A request without an origin comes from the address bar, not from a page.
    pub(crate) fn check_source(&self, headers: &HeaderMap) -> Result<(), Denied> {
        let host = only(headers, header::HOST).ok_or(Denied::Host)?;
        if !self.hosts.iter().any(|ours| ours == host) {
            return Err(Denied::Host);
        }
        if headers.contains_key(header::ORIGIN) {
            self.check_origin(headers)
        } else {
            Ok(())
        }
    }

    /// The request comes from our page; for the WebSocket, where browsers always send the origin.
    pub(crate) fn check_origin(&self, headers: &HeaderMap) -> Result<(), Denied> {
        let origin = only(headers, header::ORIGIN).ok_or(Denied::Origin)?;
        if self.origins.iter().any(|ours| ours == origin) {
            Ok(())
        } else {
            Err(Denied::Origin)
        }
    }

    /// What a key allows.
    pub(crate) fn role_of(&self, key: &str) -> Result<Role, Denied> {
        let access = self
            .accesses()
            .into_iter()
            .find(|access| access.key.matches(key));
        access.map(|access| access.role).ok_or(Denied::Key)
    }

    /// The key for the token in a query, or the one that the page presents, whichever allows more. A page without a key
    /// presents something random.
    pub(crate) fn key(&self, shown: &str, query: &str) -> Result<&str, Denied> {
        let has = self.role_of(shown);
        let asked = self.accesses().into_iter().find_map(|access| {
            let token = query.strip_prefix(access.parameter())?;
            Some((access, token.strip_prefix('=')?))
        });
        let role = match asked {
            Some((access, token)) if has.map_or(true, |has| has < access.role) => {
                self.redeem(access, token, shown)?
            }
            _ => has?,
        };
        let Secret(key) = match role {
            Role::Controller => &self.controller.key,
            Role::Viewer => &self.viewer.key,
        };
        Ok(key)
    }

    fn redeem(&self, access: &Access, token: &str, shown: &str) -> Result<Role, Denied> {
        if access.role == Role::Viewer {
            return access
                .token
                .matches(token)
                .then_some(Role::Viewer)
                .ok_or(Denied::Token);
        }
        let further = self.further();
        let used_by = match further.iter().find(|entry| entry.token.matches(token)) {
            Some(entry) => &entry.used_by,
            None if access.token.matches(token) => &self.used_by,
            None => return Err(Denied::Token),
        };
        // A page that shows nothing could not ask again, and nobody else could after it.
        if shown.is_empty() {
            return Err(Denied::Token);
        }
        let used_by = used_by.get_or_init(|| shown.to_owned());
        if !bool::from(used_by.as_bytes().ct_eq(shown.as_bytes())) {
            return Err(Denied::Token);
        }
        let _ = self.opened.send(());
        Ok(Role::Controller)
    }
}

/// Whether an address can be served: requests must name it, so it must be one of this machine's own.
///
/// # Errors
/// [`ServeError::Unspecified`].
pub(crate) fn check_listen(at: IpAddr) -> Result<(), ServeError> {
    match at.is_unspecified() {
        true => Err(ServeError::Unspecified(at, own_address())),
        false => Ok(()),
    }
}

/// This machine's address on its network; finding it sends nothing.
fn own_address() -> Option<IpAddr> {
    let socket = std::net::UdpSocket::bind(("0.0.0.0", 0)).ok()?;
    // From the block reserved for documentation.
    socket.connect(("192.0.2.1", 9)).ok()?;
    Some(socket.local_addr().ok()?.ip()).filter(|own| !own.is_unspecified())
}

/// The value of a header that must occur exactly once.
fn only(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    let mut values = headers.get_all(name).iter();
    let value = values.next()?.to_str().ok()?;
    values.next().is_none().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    fn guard() -> Guard {
        at("127.0.0.1:8360")
    }

    fn at(address: &str) -> Guard {
        Guard::new(address.parse().unwrap(), std::sync::mpsc::channel().0).unwrap()
    }

    fn query(url: &str) -> &str {
        url.split_once('?').unwrap().1
    }

    fn headers(pairs: &[(header::HeaderName, &str)]) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            headers.append(name, HeaderValue::from_str(value).unwrap());
        }
        headers
    }

    #[test]
    fn only_this_host_by_its_exact_name_is_served() {
        let guard = guard();
        for host in ["127.0.0.1:8360", "localhost:8360"] {
            assert_eq!(
                guard.check_source(&headers(&[(header::HOST, host)])),
                Ok(())
            );
        }
        for host in [
            "evil.example:8360",
            "127.0.0.1",
            "127.0.0.1:8361",
            "127.0.0.1:8360.evil.example",
            "",
        ] {
            assert_eq!(
                guard.check_source(&headers(&[(header::HOST, host)])),
                Err(Denied::Host),
                "{host}"
            );
        }
        assert_eq!(guard.check_source(&HeaderMap::new()), Err(Denied::Host));
        // Of two, nobody knows which one counts.
        let (host, ours) = (header::HOST, "127.0.0.1:8360");
        let twice = headers(&[(host.clone(), ours), (host.clone(), "evil.example")]);
        assert_eq!(guard.check_source(&twice), Err(Denied::Host));
        let (origin, ours) = (header::ORIGIN, "http://127.0.0.1:8360");
        let twice = headers(&[(origin.clone(), ours), (origin, "http://evil.example")]);
        assert_eq!(guard.check_origin(&twice), Err(Denied::Origin));
    }

    #[test]
    fn a_page_of_another_origin_is_refused() {
        let guard = guard();
        let from =
            |origin: &str| headers(&[(header::HOST, "127.0.0.1:8360"), (header::ORIGIN, origin)]);
        assert_eq!(guard.check_source(&from("http://127.0.0.1:8360")), Ok(()));
        for origin in [
            "http://evil.example",
            "null",
            "https://127.0.0.1:8360",
            "http://127.0.0.1:8361",
        ] {
            assert_eq!(
                guard.check_source(&from(origin)),
                Err(Denied::Origin),
                "{origin}"
            );
        }
        assert_eq!(
            guard.check_origin(&headers(&[(header::HOST, "127.0.0.1:8360")])),
            Err(Denied::Origin)
        );
    }

    #[test]
    fn the_token_opens_once_and_the_key_from_then_on() {
        let guard = guard();
        let url = guard.url();
        assert_eq!(guard.key("mine", "token=0000"), Err(Denied::Token));
        // Who shows nothing gets nothing, and takes nothing from the page.
        assert_eq!(guard.key("", query(&url)), Err(Denied::Token));
        let key = guard.key("mine", query(&url)).unwrap();
        for another in ["", "min", "yours"] {
            assert_eq!(guard.key(another, query(&url)), Err(Denied::Token));
        }
        assert_eq!(guard.role_of(key), Ok(Role::Controller));
        // The browser that has the key may open the address again, and so may the page that missed the answer.
        assert_eq!(guard.key(key, query(&url)), Ok(key));
        assert_eq!(guard.key("mine", query(&url)), Ok(key));
        assert_eq!(guard.key(key, ""), Ok(key));
        for none in ["mine", "0", ""] {
            assert_eq!(guard.key(none, ""), Err(Denied::Key));
        }
    }

    #[test]
    fn another_address_opens_once_too_and_the_first_one_no_more() {
        let guard = guard();
        let (url, other) = (guard.url(), guard.another_url().unwrap());
        let key = guard.key("mine", query(&url)).unwrap();
        assert_eq!(guard.key("yours", query(&url)), Err(Denied::Token));
        assert_eq!(guard.key("yours", query(&other)), Ok(key));
        assert_eq!(guard.key("theirs", query(&other)), Err(Denied::Token));
        assert_ne!(other, guard.another_url().unwrap());
    }

    #[test]
    fn the_viewers_address_opens_for_many_and_makes_nobody_a_controller() {
        let guard = guard();
        let url = guard.viewers_url();
        let (_, token) = url.rsplit_once('=').unwrap();
        let as_controller = format!("token={token}");
        assert_eq!(guard.key("mine", &as_controller), Err(Denied::Token));
        for page in ["a", "b", "c"] {
            let key = guard.key(page, query(&url)).unwrap();
            assert_eq!(guard.role_of(key), Ok(Role::Viewer));
        }
    }

    #[test]
    fn of_two_addresses_the_one_that_allows_more_counts() {
        let guard = guard();
        let (url, viewers_url) = (guard.url(), guard.viewers_url());
        let watching = guard.key("mine", query(&viewers_url)).unwrap();
        let driving = guard.key(watching, query(&url)).unwrap();
        assert_eq!(guard.role_of(driving), Ok(Role::Controller));
        assert_eq!(guard.key(driving, query(&viewers_url)), Ok(driving));
    }

    #[test]
    fn an_address_of_the_network_is_served_under_its_own_name_only() {
        let guard = at("192.168.1.7:8360");
        let host = |host: &str| guard.check_source(&headers(&[(header::HOST, host)]));
        assert_eq!(host("192.168.1.7:8360"), Ok(()));
        assert_eq!(host("localhost:8360"), Err(Denied::Host));
        let wildcard = check_listen("0.0.0.0".parse().unwrap()).unwrap_err();
        let wildcard = wildcard.to_string();
        assert!(wildcard.contains("this computer's own"), "{wildcard}");
        assert!(check_listen("::".parse().unwrap()).is_err());
        assert!(check_listen("192.168.1.7".parse().unwrap()).is_ok());
    }
}
