//! The web server: the dashboard's files and its WebSocket, behind the [`Guard`].

mod recordings;
mod tuning;

use crate::assets;
use crate::guard::{Denied, Guard, Role};
use crate::socket::{self, Hub};
use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{Extension, FromRef, Request, State, WebSocketUpgrade};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Uri, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use rumbo_session::PageId;
use std::sync::Arc;

/// Sent with every answer.
const SECURITY_HEADERS: [(HeaderName, HeaderValue); 7] = [
    (
        header::CONTENT_SECURITY_POLICY,
        HeaderValue::from_static(
            // Blobs are pictures that the page itself made.
            "default-src 'self'; img-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; object-src 'none'",
        ),
    ),
    (
        header::X_CONTENT_TYPE_OPTIONS,
        HeaderValue::from_static("nosniff"),
    ),
    (header::X_FRAME_OPTIONS, HeaderValue::from_static("DENY")),
    (
        header::REFERRER_POLICY,
        HeaderValue::from_static("no-referrer"),
    ),
    (
        HeaderName::from_static("cross-origin-opener-policy"),
        HeaderValue::from_static("same-origin"),
    ),
    (
        HeaderName::from_static("cross-origin-resource-policy"),
        HeaderValue::from_static("same-origin"),
    ),
    (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
];

/// Of the page's own files, which hold nothing of anybody's: one that loads again, since some did not come, asks for those
/// only.
const SOON_AGAIN: &str = "private, max-age=10";

/// The WebSocket's protocol, as the page asks for it: this name, and its key as if it were another one.
const PROTOCOL: &str = "rumbo";
/// What a page without control may not do.
const NOT_DRIVING: &str = "another page has control; take it first";

/// Those of all robots, at least one.
#[derive(Clone)]
struct Hubs(Arc<[Hub]>);

/// What is no robot's own is the first one's.
impl FromRef<Hubs> for Hub {
    fn from_ref(Hubs(hubs): &Hubs) -> Self {
        hubs[0].clone()
    }
}

/// The routes; nothing is reachable around the guard.
pub(crate) fn router(guard: Arc<Guard>, hubs: Vec<Hub>) -> Router {
    Router::new()
        .route("/ws", get(upgrade))
        .route("/key", post(key))
        .route("/recordings", get(recordings::list))
        .route(
            "/recordings/{name}",
            get(recordings::content).delete(recordings::delete),
        )
        .route("/recordings/{name}/replay", post(recordings::replay))
        .route("/explain", get(explain))
        .route("/robot", post(wired))
        .route("/tune", get(tuning::offers))
        .route("/tune/search", get(tuning::search))
        .fallback(file)
        .with_state(Hubs(hubs.into()))
        .layer(middleware::from_fn_with_state(Arc::clone(&guard), admit))
        .layer(Extension(guard))
}

impl IntoResponse for Denied {
    fn into_response(self) -> Response {
        (StatusCode::FORBIDDEN, self.explanation()).into_response()
    }
}

/// Lets a request in, or says why not.
async fn admit(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let mut response = match guard.check_source(request.headers()) {
        Ok(()) => next.run(request).await,
        Err(denied) => denied.into_response(),
    };
    let kept = response.headers_mut().remove(header::CACHE_CONTROL);
    response.headers_mut().extend(SECURITY_HEADERS);
    if let Some(kept) = kept {
        response.headers_mut().insert(header::CACHE_CONTROL, kept);
    }
    response
}

/// A page asks for its key: with the one that it has, or something random, and the token of its address, if any.
async fn key(
    Extension(guard): Extension<Arc<Guard>>,
    uri: Uri,
    headers: HeaderMap,
) -> Result<String, Denied> {
    guard.check_origin(&headers)?;
    guard
        .key(bearer(&headers), uri.query().unwrap_or_default())
        .map(str::to_owned)
}

/// The key that a request presents.
fn bearer(headers: &HeaderMap) -> &str {
    let shown = headers.get(header::AUTHORIZATION);
    let shown = shown.and_then(|value| value.to_str().ok()?.strip_prefix("Bearer "));
    shown.unwrap_or_default()
}

/// What the key of a WebSocket that our page opens allows.
fn role_of_socket(guard: &Guard, headers: &HeaderMap) -> Result<Role, Denied> {
    guard.check_origin(headers)?;
    let protocols = headers.get_all(header::SEC_WEBSOCKET_PROTOCOL).iter();
    protocols
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(','))
        .find_map(|key| guard.role_of(key.trim()).ok())
        .ok_or(Denied::Key)
}

/// A value in the query of an address.
fn queried<'a>(uri: &'a Uri, name: &str) -> Option<&'a str> {
    let mut parts = uri.query()?.split('&');
    parts.find_map(|part| part.strip_prefix(name)?.strip_prefix('='))
}

/// What explains a stretch, `from` a time `to` another \[s\], of what the pages of a robot see.
async fn explain(
    State(Hubs(hubs)): State<Hubs>,
    Extension(guard): Extension<Arc<Guard>>,
    uri: Uri,
    headers: HeaderMap,
) -> Result<Response, Denied> {
    guard.role_of(bearer(&headers))?;
    let time_s = |name| queried(&uri, name).and_then(|text| text.parse::<f64>().ok());
    let (Some(from_s), Some(to_s)) = (time_s("from"), time_s("to")) else {
        let text = "say from when to when, in seconds: /explain?from=1&to=3";
        return Ok((StatusCode::BAD_REQUEST, text).into_response());
    };
    let board = named(&hubs, &uri).board;
    // In a thread of its own: STOP does not wait for it.
    let causes = tokio::task::spawn_blocking(move || board.explain(from_s, to_s)).await;
    let json = serde_json::to_string(&causes.unwrap_or_default()).unwrap_or_default();
    Ok(([(header::CONTENT_TYPE, "application/json")], json).into_response())
}

/// Answers a page of this computer that wires a robot: in a thread of its own, since it reads files.
async fn wired(
    State(hub): State<Hub>,
    Extension(guard): Extension<Arc<Guard>>,
    headers: HeaderMap,
    request: Bytes,
) -> Result<Response, Denied> {
    guard.role_of(bearer(&headers))?;
    let Some(wired) = hub.wired.filter(|_| hub.local) else {
        return Ok((StatusCode::NOT_FOUND, "no robot is wired here").into_response());
    };
    let request = match serde_json::from_slice(&request) {
        Ok(request) => request,
        Err(error) => return Ok((StatusCode::BAD_REQUEST, error.to_string()).into_response()),
    };
    let answer = tokio::task::spawn_blocking(move || wired(&request)).await;
    let json = answer.unwrap_or_default().to_string();
    Ok(([(header::CONTENT_TYPE, "application/json")], json).into_response())
}

/// The robot that the address names, or the first one.
fn named(hubs: &[Hub], uri: &Uri) -> Hub {
    let named = queried(uri, "robot").and_then(|name| {
        hubs.iter()
            .find(|hub| hub.robots.get(hub.robot).is_some_and(|own| own == name))
    });
    named.unwrap_or(&hubs[0]).clone()
}

/// Whether the page that asks, which gives its number, has control, or nobody has.
fn drives(hub: &Hub, uri: &Uri) -> bool {
    let page = queried(uri, "page").and_then(|page| page.parse::<PageId>().ok());
    page.is_some_and(|page| hub.lease.drives(page))
}

/// A page of the robot that the address names, or of the first one.
async fn upgrade(
    State(Hubs(hubs)): State<Hubs>,
    uri: Uri,
    Extension(guard): Extension<Arc<Guard>>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Result<Response, Denied> {
    let role = role_of_socket(&guard, &headers)?;
    let hub = named(&hubs, &uri);
    Ok(upgrade
        .protocols([PROTOCOL])
        .max_message_size(hub.longest_message())
        .max_frame_size(hub.longest_message())
        .on_upgrade(move |socket| socket::talk(socket, hub, role)))
}

async fn file(request: Request) -> Response {
    if request.method() != Method::GET {
        return StatusCode::METHOD_NOT_ALLOWED.into_response();
    }
    match assets::find(request.uri().path()) {
        Some(asset) if asset.mime == assets::HTML => (
            [(header::CONTENT_TYPE, asset.mime)],
            Body::from(asset.bytes),
        )
            .into_response(),
        Some(asset) => (
            [
                (header::CONTENT_TYPE, asset.mime),
                (header::CACHE_CONTROL, SOON_AGAIN),
            ],
            Body::from(asset.bytes),
        )
            .into_response(),
        None => (StatusCode::NOT_FOUND, "no such page").into_response(),
    }
}
