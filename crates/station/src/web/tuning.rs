//! Requests for a tuning: with the key of a page that may drive, a search only while no other page has control.

use super::{Hubs, NOT_DRIVING, PROTOCOL, bearer, drives, named, role_of_socket};
use crate::guard::{Denied, Guard, Role};
use crate::socket::{Hub, PING, SEND_TIMEOUT, SILENCE};
use crate::tuning::{NotTuned, Tuning};
use axum::body::Bytes;
use axum::extract::ws::{Message, WebSocket};
use axum::extract::{Extension, State, WebSocketUpgrade};
use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::{Instant, interval, timeout};

/// Longest request \[bytes\].
const MOST_REQUEST: usize = 4_096;
/// A page sends its request within this time.
const REQUEST: Duration = Duration::from_secs(5);
/// Interval of the news.
const NEWS: Duration = Duration::from_millis(250);

/// Why a request is refused.
pub(super) enum Refused {
    Denied(Denied),
    /// Nothing is tuned here: a real robot, or a replay.
    None,
    /// The work ended by a fault of its own.
    Broken,
}

impl From<Denied> for Refused {
    fn from(denied: Denied) -> Self {
        Self::Denied(denied)
    }
}

impl IntoResponse for Refused {
    fn into_response(self) -> Response {
        match self {
            Self::Denied(denied) => denied.into_response(),
            Self::None => (
                StatusCode::NOT_FOUND,
                "parameters are tuned in the lab of a simulated robot",
            )
                .into_response(),
            Self::Broken => (
                StatusCode::INTERNAL_SERVER_ERROR,
                "a fault of the program; please report it",
            )
                .into_response(),
        }
    }
}

/// What there is to choose from.
pub(super) async fn offers(
    State(hub): State<Hub>,
    Extension(guard): Extension<Arc<Guard>>,
    headers: HeaderMap,
) -> Result<Response, Refused> {
    let tuning = admitted(&hub, guard.role_of(bearer(&headers))?)?;
    // In a thread of its own: STOP does not wait for files.
    let offers = tokio::task::spawn_blocking(move || tuning.offers()).await;
    let offers = offers.map_err(|_| Refused::Broken)?;
    let json = [(header::CONTENT_TYPE, "application/json")];
    Ok((json, offers.to_string()).into_response())
}

/// A search, over a WebSocket of its own: it ends with that.
pub(super) async fn search(
    State(Hubs(hubs)): State<Hubs>,
    uri: Uri,
    Extension(guard): Extension<Arc<Guard>>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Result<Response, Refused> {
    let role = role_of_socket(&guard, &headers)?;
    let hub = named(&hubs, &uri);
    let tuning = admitted(&hub, role)?;
    let may = drives(&hub, &uri);
    Ok(upgrade
        .protocols([PROTOCOL])
        .max_message_size(MOST_REQUEST)
        .max_frame_size(MOST_REQUEST)
        .on_upgrade(move |socket| talk(socket, tuning, may)))
}

fn admitted(hub: &Hub, role: Role) -> Result<Arc<Tuning>, Refused> {
    match role {
        Role::Controller => hub.tuning.clone().ok_or(Refused::None),
        Role::Viewer => Err(Denied::Key.into()),
    }
}

/// Serves one search: takes the page's request, says how far it is, `{"share": 0.4}`, and at last `{"found": ...}` or
/// `{"error": "why"}`. A page without control (`may`) gets that as the error.
async fn talk(mut page: WebSocket, tuning: Arc<Tuning>, may: bool) {
    let done = match may {
        true => look(&mut page, &tuning).await,
        false => Some(Err(NotTuned(NOT_DRIVING.into()))),
    };
    let last = match done {
        Some(Ok(found)) => json!({ "found": found }),
        Some(Err(NotTuned(why))) => json!({ "error": why }),
        // Nobody is left to read it.
        None => return,
    };
    let last = Message::Text(last.to_string().into());
    if put(&mut page, last).await.is_some() {
        // The page closes when it has read it: a connection with unread bytes would be reset, and the last words lost.
        let _ = timeout(SEND_TIMEOUT, async {
            while let Some(Ok(_)) = page.recv().await {}
        })
        .await;
    }
}

/// What was found, or why not; `None`: the page is gone.
async fn look(page: &mut WebSocket, tuning: &Tuning) -> Option<Result<Value, NotTuned>> {
    let request = match timeout(REQUEST, page.recv()).await {
        Ok(Some(Ok(Message::Text(request)))) => request.to_string(),
        _ => return None,
    };
    let mut search = match tuning.begin(request).await {
        Ok(search) => search,
        Err(why) => return Some(Err(why)),
    };
    let (mut news, mut pings) = (interval(NEWS), interval(PING));
    let mut last_frame = Instant::now();
    loop {
        tokio::select! {
            found = search.found() => return Some(found),
            message = page.recv() => match message {
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => last_frame = Instant::now(),
                _ => return None,
            },
            _ = news.tick() => {
                let text = json!({ "share": search.share() }).to_string();
                put(page, Message::Text(text.into())).await?;
            }
            _ = pings.tick() => {
                if last_frame.elapsed() > SILENCE {
                    return None;
                }
                put(page, Message::Ping(Bytes::new())).await?;
            }
        }
    }
}

async fn put(page: &mut WebSocket, message: Message) -> Option<()> {
    timeout(SEND_TIMEOUT, page.send(message)).await.ok()?.ok()
}
