//! The web server: the dashboard's files and its WebSocket, behind the [`Guard`].

use crate::assets;
use crate::guard::{Denied, Guard};
use crate::socket::{self, Hub};
use axum::Router;
use axum::body::Body;
use axum::extract::{Request, State, WebSocketUpgrade};
use axum::http::{HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use std::sync::Arc;

/// Sent with every answer.
const SECURITY_HEADERS: [(HeaderName, HeaderValue); 7] = [
    (
        header::CONTENT_SECURITY_POLICY,
        HeaderValue::from_static(
            "default-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; object-src 'none'",
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

/// The routes; nothing is reachable around the guard.
pub(crate) fn router(guard: Arc<Guard>, hub: Hub) -> Router {
    Router::new()
        .route("/ws", get(upgrade))
        .fallback(file)
        .with_state(hub)
        .layer(middleware::from_fn_with_state(guard, admit))
}

/// Lets a request in, or says why not.
async fn admit(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let mut response = match check(&guard, &request) {
        Ok(None) => next.run(request).await,
        Ok(Some(cookie)) => {
            // The token does not stay in the address.
            (
                StatusCode::SEE_OTHER,
                [
                    (header::LOCATION, "/".to_owned()),
                    (header::SET_COOKIE, cookie),
                ],
            )
                .into_response()
        }
        Err(denied) => (StatusCode::FORBIDDEN, denied.explanation()).into_response(),
    };
    response.headers_mut().extend(SECURITY_HEADERS);
    response
}

/// Whether the request may pass; a cookie to set when it brought the token.
fn check(guard: &Guard, request: &Request) -> Result<Option<String>, Denied> {
    guard.check_source(request.headers())?;
    if request.uri().path() == "/ws" {
        guard.check_origin(request.headers())?;
    }
    let token = request
        .uri()
        .query()
        .and_then(|query| query.strip_prefix("token="));
    match (guard.check_cookie(request.headers()), token) {
        (Ok(()), _) => Ok(None),
        (Err(_), Some(token)) if request.uri().path() == "/" => guard.redeem(token).map(Some),
        (Err(denied), _) => Err(denied),
    }
}

async fn upgrade(State(hub): State<Hub>, upgrade: WebSocketUpgrade) -> Response {
    upgrade
        .max_message_size(socket::MAX_MESSAGE)
        .max_frame_size(socket::MAX_MESSAGE)
        .on_upgrade(|socket| socket::talk(socket, hub))
}

async fn file(request: Request) -> Response {
    if request.method() != Method::GET {
        return StatusCode::METHOD_NOT_ALLOWED.into_response();
    }
    match assets::find(request.uri().path()) {
        Some(asset) => (
            [(header::CONTENT_TYPE, asset.mime)],
            Body::from(asset.bytes),
        )
            .into_response(),
        None => (StatusCode::NOT_FOUND, "no such page").into_response(),
    }
}
