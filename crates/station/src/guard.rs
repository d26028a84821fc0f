//! Who may use the dashboard: the person at this machine, and no page of the internet.
//!
//! A web page anywhere can make the browser send requests to 127.0.0.1, and with a name of its own that resolves there it can
//! read the answers (DNS rebinding). So every request must name exactly this host, must come from this origin if it
//! comes from a page, and must carry a cookie that was given for the one-time token in the address that the lab printed.

use axum::http::{HeaderMap, header};
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

/// Decides on requests.
#[derive(Debug)]
pub(crate) struct Guard {
    port: u16,
    hosts: [String; 2],
    origins: [String; 2],
    token: Secret,
    token_used: AtomicBool,
    cookie: Secret,
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
    /// A guard for the dashboard on `port`.
    ///
    /// # Errors
    /// When the system gives no randomness.
    pub(crate) fn new(port: u16) -> Result<Self, getrandom::Error> {
        let hosts = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
        Ok(Self {
            port,
            origins: hosts.each_ref().map(|host| format!("http://{host}")),
            hosts,
            token: Secret::new()?,
            token_used: AtomicBool::new(false),
            cookie: Secret::new()?,
        })
    }

    /// The address to open, once.
    pub(crate) fn url(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.token.0)
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

    /// The request carries the cookie.
    pub(crate) fn check_cookie(&self, headers: &HeaderMap) -> Result<(), Denied> {
        let name = self.cookie_name();
        let valid = headers
            .get_all(header::COOKIE)
            .iter()
            .filter_map(|value| value.to_str().ok())
            .flat_map(|value| value.split(';'))
            .filter_map(|pair| pair.trim().split_once('='))
            .any(|(key, value)| key == name && self.cookie.matches(value));
        if valid { Ok(()) } else { Err(Denied::Cookie) }
    }

    /// Takes the token of the query, once, and gives the cookie to set.
    pub(crate) fn redeem(&self, token: &str) -> Result<String, Denied> {
        if !self.token.matches(token) || self.token_used.swap(true, Ordering::SeqCst) {
            return Err(Denied::Token);
        }
        Ok(format!(
            "{}={}; HttpOnly; SameSite=Strict; Path=/",
            self.cookie_name(),
            self.cookie.0
        ))
    }

    /// Cookies are shared between the ports of a host: the name tells two labs apart.
    fn cookie_name(&self) -> String {
        format!("rumbo_{}", self.port)
    }
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

    fn headers(pairs: &[(header::HeaderName, &str)]) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            headers.append(name, HeaderValue::from_str(value).unwrap());
        }
        headers
    }

    #[test]
    fn only_this_host_by_its_exact_name_is_served() {
        let guard = Guard::new(8360).unwrap();
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
        let guard = Guard::new(8360).unwrap();
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
        let guard = Guard::new(8360).unwrap();
        let token = guard.url().rsplit_once('=').unwrap().1.to_owned();
        assert_eq!(guard.redeem("0000"), Err(Denied::Token));
        let cookie = guard.redeem(&token).unwrap();
        assert!(cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"));
        assert_eq!(guard.redeem(&token), Err(Denied::Token));
        let pair = cookie.split(';').next().unwrap();
        assert_eq!(
            guard.check_cookie(&headers(&[(header::COOKIE, &format!("other=1; {pair}"))])),
            Ok(())
        );
        assert_eq!(
            guard.check_cookie(&headers(&[(header::COOKIE, "rumbo_8360=0")])),
            Err(Denied::Cookie)
        );
        assert_eq!(guard.check_cookie(&HeaderMap::new()), Err(Denied::Cookie));
    }
}
