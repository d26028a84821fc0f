//! A viewer of Foxglove's protocol on a live session.
#![cfg(feature = "foxglove")]
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use futures_util::{SinkExt, StreamExt};
use rumbo_station::{Bridge, LabConfig, ServeAt, serve};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::time::Duration;
use support::Toy;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::http::HeaderValue;

/// Long enough for any machine; nothing is judged by it.
const PATIENCE: Duration = Duration::from_secs(20);

#[tokio::test]
async fn a_viewer_sees_the_signals_and_poses_and_can_do_nothing() {
    let bridge = std::thread::spawn(|| Bridge::start(0))
        .join()
        .unwrap()
        .unwrap();
    let address = bridge.address();
    let config = LabConfig {
        at: ServeAt::here(0),
        speed: 4.0,
        bridge: Some(bridge),
        ..LabConfig::default()
    };
    let _lab = serve(config, Box::new(Toy::default())).unwrap();
    let mut request = address.as_str().into_client_request().unwrap();
    request.headers_mut().insert(
        "Sec-WebSocket-Protocol",
        HeaderValue::from_static("foxglove.sdk.v1"),
    );
    let (mut viewer, _) = tokio_tungstenite::connect_async(request).await.unwrap();
    let watch = async {
        let mut channels: BTreeMap<u64, String> = BTreeMap::new();
        let mut seen: BTreeMap<String, Value> = BTreeMap::new();
        while !(["/telemetry", "/pose/estimated", "/world", "/state"]
            .iter()
            .all(|topic| seen.contains_key(*topic)))
        {
            match viewer.next().await.unwrap().unwrap() {
                Message::Text(text) => {
                    let message: Value = serde_json::from_str(&text).unwrap();
                    if message["op"] == "serverInfo" {
                        // It offers nothing that a viewer could set, call or publish.
                        assert_eq!(message["capabilities"], json!([]), "{message}");
                    }
                    for channel in message["channels"].as_array().into_iter().flatten() {
                        assert_eq!(channel["schemaEncoding"], "jsonschema");
                        let id = channel["id"].as_u64().unwrap();
                        channels.insert(id, channel["topic"].as_str().unwrap().into());
                        let order = json!({"op": "subscribe", "subscriptions": [{"id": id, "channelId": id}]});
                        viewer.send(Message::text(order.to_string())).await.unwrap();
                    }
                }
                Message::Binary(bytes) if bytes[0] == 1 => {
                    let id = u32::from_le_bytes(bytes[1..5].try_into().unwrap());
                    let message = serde_json::from_slice(&bytes[13..]).unwrap();
                    seen.insert(channels[&u64::from(id)].clone(), message);
                }
                _ => {}
            }
        }
        seen
    };
    let seen = tokio::time::timeout(PATIENCE, watch).await.unwrap();
    assert!(seen["/telemetry"]["range_front_m"].as_f64().unwrap() > 0.5);
    assert_eq!(seen["/pose/estimated"]["frame_id"], "world");
    assert_eq!(
        seen["/world"]["entities"][0]["lines"][0]["points"]
            .as_array()
            .unwrap()
            .len(),
        2
    );
}
