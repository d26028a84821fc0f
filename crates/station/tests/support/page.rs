//! The lab's dashboard as a page, and as somebody else's, meets it.

use super::support::Toy;
use futures_util::{SinkExt, StreamExt};
use rumbo_station::{Lab, LabConfig, ServeAt, serve};
use serde_json::Value;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::http::HeaderValue;
use tokio_tungstenite::tungstenite::{Error, Message};

/// Long enough for any machine; nothing is judged by it.
pub(crate) const PATIENCE: Duration = Duration::from_secs(20);

#[allow(dead_code, reason = "not every test is about the toy alone")]
pub(crate) fn start(speed: f64) -> Lab {
    serve(
        LabConfig {
            at: ServeAt::here(0),
            speed,
            ..LabConfig::default()
        },
        Box::new(Toy::default()),
    )
    .unwrap()
}

pub(crate) fn host(lab: &Lab) -> String {
    lab.url()
        .trim_start_matches("http://")
        .split('/')
        .next()
        .unwrap()
        .to_owned()
}

/// One request with these header lines; the whole answer.
pub(crate) fn ask(at: &str, method: &str, target: &str, headers: &[(&str, &str)]) -> String {
    let mut stream = TcpStream::connect(at).unwrap();
    let mut text = format!("{method} {target} HTTP/1.1\r\nConnection: close\r\n");
    for (name, value) in headers {
        text += &format!("{name}: {value}\r\n");
    }
    stream.write_all((text + "\r\n").as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

pub(crate) fn status(answer: &str) -> &str {
    answer.split(' ').nth(1).unwrap()
}

/// The key for the token in the lab's address.
pub(crate) fn open(lab: &Lab) -> String {
    redeem(lab, lab.url())
}

/// The key for the token in an address.
pub(crate) fn redeem(lab: &Lab, url: &str) -> String {
    let answer = ask_for_key(lab, url, &[("Authorization", "Bearer a page of a test")]);
    assert_eq!(status(&answer), "200", "{answer}");
    answer.split_once("\r\n\r\n").unwrap().1.to_owned()
}

/// The answer to a page that was opened at this address and asks for its key, with these header lines besides.
pub(crate) fn ask_for_key(lab: &Lab, url: &str, headers: &[(&str, &str)]) -> String {
    let host = host(lab);
    let query = url.split_once('?').map_or("", |(_, query)| query);
    let origin = format!("http://{host}");
    let own = [("Host", host.as_str()), ("Origin", &origin)];
    ask(
        &host,
        "POST",
        &format!("/key?{query}"),
        &[&own, headers].concat(),
    )
}

pub(crate) type Page =
    tokio_tungstenite::WebSocketStream<tokio_tungstenite::MaybeTlsStream<tokio::net::TcpStream>>;

pub(crate) async fn connect(lab: &Lab, key: &str, origin: Option<&str>) -> Result<Page, Error> {
    connect_at("/ws", lab, key, origin).await
}

#[allow(dead_code, reason = "not every test has an address of its own")]
pub(crate) async fn connect_at(
    at: &str,
    lab: &Lab,
    key: &str,
    origin: Option<&str>,
) -> Result<Page, Error> {
    let address = format!("ws://{}{at}", host(lab));
    let mut request = address.into_client_request().unwrap();
    let protocols = HeaderValue::from_str(&format!("rumbo, {key}")).unwrap();
    let headers = request.headers_mut();
    headers.insert("Sec-WebSocket-Protocol", protocols);
    if let Some(origin) = origin {
        headers.insert("Origin", HeaderValue::from_str(origin).unwrap());
    }
    tokio_tungstenite::connect_async(request)
        .await
        .map(|(page, _)| page)
}

pub(crate) async fn connect_own(lab: &Lab, key: &str) -> Page {
    let origin = format!("http://{}", host(lab));
    connect(lab, key, Some(&origin)).await.unwrap()
}

/// The page of one of several robots.
#[allow(dead_code, reason = "not every test has several")]
pub(crate) async fn connect_to(robot: &str, lab: &Lab, key: &str) -> Page {
    let origin = format!("http://{}", host(lab));
    let at = format!("/ws?robot={robot}");
    connect_at(&at, lab, key, Some(&origin)).await.unwrap()
}

pub(crate) async fn say(page: &mut Page, order: Value) {
    page.send(Message::text(order.to_string())).await.unwrap();
}

/// Reads on until `wanted` finds what it looks for.
pub(crate) async fn wait_for<T>(page: &mut Page, mut wanted: impl FnMut(&Value) -> Option<T>) -> T {
    let search = async {
        loop {
            let message = page.next().await.unwrap().unwrap();
            if let Message::Text(text) = message
                && let Some(found) = wanted(&serde_json::from_str(&text).unwrap())
            {
                return found;
            }
        }
    };
    tokio::time::timeout(PATIENCE, search).await.unwrap()
}

pub(crate) fn event(message: &Value, part: &str) -> Option<()> {
    let texts = message["events"].as_array()?;
    texts
        .iter()
        .any(|event| event["text"].as_str().unwrap().contains(part))
        .then_some(())
}

pub(crate) fn armed(message: &Value, wanted: bool) -> Option<()> {
    (message["state"]["robot"]["armed"] == wanted).then_some(())
}
