//! Who may use the dashboard: who has the address that was printed, and no page of the internet.
//!
//! A web page anywhere can make the browser send requests to 127.0.0.1, and with a name of its own that resolves there it can
//! read the answers (DNS rebinding). So every request must name exactly this host, must come from this origin if it
//! comes from a page, and must carry a cookie that was given for a token in an address that was printed. There are two: the
//! controller's opens once, so that an address seen over a shoulder is worth nothing; the viewers' opens for whoever has it, and lets
//! them watch and stop the robot.

use axum::http::{HeaderMap, header};
use std::net::{IpAddr, SocketAddr};
use std::sync::atomic::{AtomicBool, Ordering};
use subtle::ConstantTimeEq;

/// A random secret of 256 bits, in hexadecimal.
#[derive(Debug)]
struct Secret(String);

impl Secret {
    fn new() -> Result<Self, getrandom::Error> {
        let mut bytes = [0u8; 32];
        getrandom::fill(&mut bytes)?;
        Ok(Self(
            bytes.iter().map(|byte| format!("{byte:02x}")).collect(),
        ))
    }

    /// Compares in a time that tells nothing about the secret.
    fn matches(&self, offered: &str) -> bool {
        self.0.as_bytes().ct_eq(offered.as_bytes()).into()
    }
}

/// What who has a cookie may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Role {
    /// Watch, and stop the robot.
    Viewer,
    /// Everything, while nobody else has control.
    Controller,
}

/// What opens the dashboard for a role.
#[derive(Debug)]
struct Key {
    role: Role,
    token: Secret,
    cookie: Secret,
}

impl Key {
    fn new(role: Role) -> Result<Self, getrandom::Error> {
        Ok(Self {
            role,
            token: Secret::new()?,
            cookie: Secret::new()?,
        })
    }

    /// The name of the token in the address.
    fn parameter(&self) -> &'static str {
        match self.role {
            Role::Controller => "token",
            Role::Viewer => "watch",
        }
    }

    /// Cookies are shared between the ports of a host: the name tells two labs apart.
    fn cookie_name(&self, port: u16) -> String {
        match self.role {
            Role::Controller => format!("rumbo_{port}"),
            Role::Viewer => format!("rumbo_watch_{port}"),
        }
    }
}

/// Decides on requests.
#[derive(Debug)]
pub(crate) struct Guard {
    at: SocketAddr,
    hosts: Vec<String>,
    origins: Vec<String>,
    controller: Key,
    viewer: Key,
    /// The controller's token has been used.
    token_used: AtomicBool,
}

/// Why a request is turned away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Denied {
    /// It names another host.
    Host,
    /// It comes from a page of another origin, or from no page where one is needed.
    Origin,
    /// It carries no valid cookie.
    Cookie,
    /// Its token is wrong or was used already.
    Token,
}

impl Denied {
    /// What the person reads.
    pub(crate) fn explanation(self) -> &'static str {
        match self {
            Self::Host => {
                "refused: this address is not the dashboard's; open the one that rumbo printed"
            }
            Self::Origin => "refused: only the dashboard's own page may talk to the robot",
            Self::Cookie => {
                "refused: open the address that rumbo printed when it started, with its token"
            }
            Self::Token => {
                "refused: this address was used already or is of an earlier start; use the browser in which it was opened, or start rumbo again"
            }
        }
    }
}

impl Guard {
    /// A guard for the dashboard at this address.
    ///
    /// # Errors
    /// When the system gives no randomness.
    pub(crate) fn new(at: SocketAddr) -> Result<Self, getrandom::Error> {
        let mut hosts = vec![at.to_string()];
        if at.ip().is_loopback() {
            hosts.push(format!("localhost:{}", at.port()));
        }
        Ok(Self {
            at,
            origins: hosts.iter().map(|host| format!("http://{host}")).collect(),
            hosts,
            controller: Key::new(Role::Controller)?,
            viewer: Key::new(Role::Viewer)?,
            token_used: AtomicBool::new(false),
        })
    }

    /// The address to open, once.
    pub(crate) fn url(&self) -> String {
        self.address_of(&self.controller)
    }

    /// The address for those who watch.
    pub(crate) fn viewers_url(&self) -> String {
        self.address_of(&self.viewer)
    }

    fn address_of(&self, key: &Key) -> String {
        format!("http://{}/?{}={}", self.at, key.parameter(), key.token.0)
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

    /// The request comes from our page; for the WebSocket, where browsers always say.
    pub(crate) fn check_origin(&self, headers: &HeaderMap) -> Result<(), Denied> {
        let origin = only(headers, header::ORIGIN).ok_or(Denied::Origin)?;
        if self.origins.iter().any(|ours| ours == origin) {
            Ok(())
        } else {
            Err(Denied::Origin)
        }
    }

    /// What the cookie that the request carries allows.
    pub(crate) fn check_cookie(&self, headers: &HeaderMap) -> Result<Role, Denied> {
        [&self.controller, &self.viewer]
            .into_iter()
            .find(|key| self.carries(headers, key))
            .map(|key| key.role)
            .ok_or(Denied::Cookie)
    }

    fn carries(&self, headers: &HeaderMap, key: &Key) -> bool {
        let name = key.cookie_name(self.at.port());
        headers
            .get_all(header::COOKIE)
            .iter()
            .filter_map(|value| value.to_str().ok())
            .flat_map(|value| value.split(';'))
            .filter_map(|pair| pair.trim().split_once('='))
            .any(|(known, value)| known == name && key.cookie.matches(value))
    }

    /// The token in a query, if there is one for a role.
    pub(crate) fn token_in<'a>(&self, query: &'a str) -> Option<(Role, &'a str)> {
        [&self.controller, &self.viewer]
            .into_iter()
            .find_map(|key| {
                let token = query.strip_prefix(key.parameter())?.strip_prefix('=')?;
                Some((key.role, token))
            })
    }

    /// Takes the token of the query, the controller's once, and gives the cookie to set.
    pub(crate) fn redeem(&self, role: Role, token: &str) -> Result<String, Denied> {
        let key = match role {
            Role::Controller => &self.controller,
            Role::Viewer => &self.viewer,
        };
        if !key.token.matches(token)
            || (role == Role::Controller && self.token_used.swap(true, Ordering::SeqCst))
        {
            return Err(Denied::Token);
        }
        Ok(format!(
            "{}={}; HttpOnly; SameSite=Strict; Path=/",
            key.cookie_name(self.at.port()),
            key.cookie.0
        ))
    }
}

/// Whether an address can be served: requests must name it, so it must be one of this machine's own.
///
/// # Errors
/// What to give instead.
pub(crate) fn check_listen(at: IpAddr) -> Result<(), String> {
    if !at.is_unspecified() {
        return Ok(());
    }
    let own = own_address().map_or_else(String::new, |own| format!(", such as {own}"));
    Err(format!(
        "{at} is no address that a browser can ask for: give this computer's own{own}"
    ))
}

/// The address with which this machine goes out; nothing is sent to find it.
fn own_address() -> Option<IpAddr> {
    let socket = std::net::UdpSocket::bind(("0.0.0.0", 0)).ok()?;
    // Of the block kept for documentation.
    socket.connect(("192.0.2.1", 9)).ok()?;
    Some(socket.local_addr().ok()?.ip()).filter(|own| !own.is_unspecified())
}

/// The value of a header that must be there exactly once.
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
        Guard::new("127.0.0.1:8360".parse().unwrap()).unwrap()
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
    fn the_token_opens_once_and_the_cookie_from_then_on() {
        let guard = guard();
        let token = guard.url().rsplit_once('=').unwrap().1.to_owned();
        assert_eq!(guard.redeem(Role::Controller, "0000"), Err(Denied::Token));
        let cookie = guard.redeem(Role::Controller, &token).unwrap();
        assert!(cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"));
        assert_eq!(guard.redeem(Role::Controller, &token), Err(Denied::Token));
        let pair = cookie.split(';').next().unwrap();
        assert_eq!(
            guard.check_cookie(&headers(&[(header::COOKIE, &format!("other=1; {pair}"))])),
            Ok(Role::Controller)
        );
        assert_eq!(
            guard.check_cookie(&headers(&[(header::COOKIE, "rumbo_8360=0")])),
            Err(Denied::Cookie)
        );
        assert_eq!(guard.check_cookie(&HeaderMap::new()), Err(Denied::Cookie));
    }

    #[test]
    fn the_viewers_address_opens_for_many_and_makes_nobody_a_controller() {
        let guard = guard();
        let url = guard.viewers_url();
        let (role, token) = guard.token_in(url.split_once('?').unwrap().1).unwrap();
        assert_eq!(role, Role::Viewer);
        assert_eq!(guard.redeem(Role::Controller, token), Err(Denied::Token));
        for _ in 0..3 {
            let cookie = guard.redeem(role, token).unwrap();
            let pair = cookie.split(';').next().unwrap();
            let cookies = headers(&[(header::COOKIE, pair)]);
            assert_eq!(guard.check_cookie(&cookies), Ok(Role::Viewer));
            // Under the controller's name it is worth nothing.
            let (_, value) = pair.split_once('=').unwrap();
            let renamed = format!("rumbo_8360={value}");
            let renamed = headers(&[(header::COOKIE, &renamed)]);
            assert_eq!(guard.check_cookie(&renamed), Err(Denied::Cookie));
        }
    }

    #[test]
    fn an_address_of_the_network_is_served_under_its_own_name_only() {
        let guard = Guard::new("192.168.1.7:8360".parse().unwrap()).unwrap();
        let host = |host: &str| guard.check_source(&headers(&[(header::HOST, host)]));
        assert_eq!(host("192.168.1.7:8360"), Ok(()));
        assert_eq!(host("localhost:8360"), Err(Denied::Host));
        let wildcard = check_listen("0.0.0.0".parse().unwrap()).unwrap_err();
        assert!(wildcard.contains("this computer's own"), "{wildcard}");
        assert!(check_listen("::".parse().unwrap()).is_err());
        assert!(check_listen("192.168.1.7".parse().unwrap()).is_ok());
    }
}
