//! The web server: the dashboard's files and its WebSocket, behind the [`Guard`].

use crate::assets;
use crate::guard::{Denied, Guard, Role};
use crate::socket::{self, Hub};
use axum::Router;
use axum::body::Body;
use axum::extract::{Extension, Request, State, WebSocketUpgrade};
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
async fn admit(State(guard): State<Arc<Guard>>, mut request: Request, next: Next) -> Response {
    let mut response = match check(&guard, &request) {
        Ok(Pass::As(role)) => {
            request.extensions_mut().insert(role);
            next.run(request).await
        }
        Ok(Pass::With(cookie)) => {
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

/// How a request may pass.
enum Pass {
    /// It has a cookie of this role.
    As(Role),
    /// It has brought a token: it gets this cookie and is to ask again.
    With(String),
}

/// Whether the request may pass. A token of a role that is not had yet counts before a cookie that is.
fn check(guard: &Guard, request: &Request) -> Result<Pass, Denied> {
    guard.check_source(request.headers())?;
    if request.uri().path() == "/ws" {
        guard.check_origin(request.headers())?;
    }
    let had = guard.check_cookie(request.headers());
    let query = request.uri().query().unwrap_or_default();
    match guard.token_in(query) {
        Some((role, token))
            if request.uri().path() == "/" && had.map_or(true, |had| had < role) =>
        {
            guard.redeem(role, token).map(Pass::With)
        }
        _ => had.map(Pass::As),
    }
}

async fn upgrade(
    State(hub): State<Hub>,
    Extension(role): Extension<Role>,
    upgrade: WebSocketUpgrade,
) -> Response {
    upgrade
        .max_message_size(socket::MAX_MESSAGE)
        .max_frame_size(socket::MAX_MESSAGE)
        .on_upgrade(move |socket| socket::talk(socket, hub, role))
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
