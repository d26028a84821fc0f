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
pub(crate) fn request(lab: &Lab, target: &str, headers: &[(&str, &str)]) -> String {
    let mut stream = TcpStream::connect(host(lab)).unwrap();
    let mut text = format!("GET {target} HTTP/1.1\r\nConnection: close\r\n");
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

/// The cookie for the token in the lab's address.
pub(crate) fn open(lab: &Lab) -> String {
    redeem(lab, lab.url())
}

/// The cookie for the token in an address.
pub(crate) fn redeem(lab: &Lab, url: &str) -> String {
    let host = host(lab);
    let target = url.split_once(&host).unwrap().1.to_owned();
    let answer = request(lab, &target, &[("Host", &host)]);
    assert_eq!(status(&answer), "303", "{answer}");
    let cookie = answer
        .lines()
        .find_map(|line| line.strip_prefix("set-cookie: "))
        .unwrap();
    cookie.split(';').next().unwrap().to_owned()
}

pub(crate) type Page =
    tokio_tungstenite::WebSocketStream<tokio_tungstenite::MaybeTlsStream<tokio::net::TcpStream>>;

pub(crate) async fn connect(lab: &Lab, cookie: &str, origin: Option<&str>) -> Result<Page, Error> {
    let mut request = format!("ws://{}/ws", host(lab))
        .into_client_request()
        .unwrap();
    request
        .headers_mut()
        .insert("Cookie", HeaderValue::from_str(cookie).unwrap());
    if let Some(origin) = origin {
        request
            .headers_mut()
            .insert("Origin", HeaderValue::from_str(origin).unwrap());
    }
    tokio_tungstenite::connect_async(request)
        .await
        .map(|(page, _)| page)
}

pub(crate) async fn connect_own(lab: &Lab, cookie: &str) -> Page {
    let origin = format!("http://{}", host(lab));
    connect(lab, cookie, Some(&origin)).await.unwrap()
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
