//! Requests for recordings: on this computer only, with the key of a page that may drive.

use super::{NOT_DRIVING, bearer, drives};
use crate::guard::{Denied, Guard, Role};
use crate::recordings::{RecordingError, Recordings};
use crate::socket::Hub;
use axum::extract::{Extension, Path, State};
use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use std::sync::Arc;

/// Why a request is refused.
pub(super) enum Refused {
    Denied(Denied),
    /// Other computers reach the page.
    Elsewhere,
    /// Nothing is recorded.
    None,
    /// Another page has control.
    NotDriving,
    Recording(RecordingError),
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
        let (status, text) = match self {
            Self::Denied(denied) => return denied.into_response(),
            Self::Elsewhere => (
                StatusCode::FORBIDDEN,
                "recordings are shown only where no other computer reaches the page".into(),
            ),
            Self::None => (StatusCode::NOT_FOUND, "nothing is recorded here".into()),
            Self::NotDriving => (StatusCode::FORBIDDEN, NOT_DRIVING.into()),
            Self::Recording(error @ RecordingError::Unknown) => {
                (StatusCode::NOT_FOUND, error.to_string())
            }
            Self::Recording(error) => (StatusCode::CONFLICT, error.to_string()),
            Self::Broken => (
                StatusCode::INTERNAL_SERVER_ERROR,
                "a fault of the program; please report it".into(),
            ),
        };
        (status, text).into_response()
    }
}

pub(super) async fn list(
    State(hub): State<Hub>,
    Extension(guard): Extension<Arc<Guard>>,
    headers: HeaderMap,
) -> Result<Response, Refused> {
    admitted(&hub, &guard, &headers)?;
    json(&with(&hub, Recordings::list).await?)
}

pub(super) async fn content(
    State(hub): State<Hub>,
    Extension(guard): Extension<Arc<Guard>>,
    headers: HeaderMap,
    Path(name): Path<String>,
) -> Result<Response, Refused> {
    admitted(&hub, &guard, &headers)?;
    let content = with(&hub, move |recordings| recordings.content(&name));
    json(&content.await?)
}

pub(super) async fn replay(
    State(hub): State<Hub>,
    Extension(guard): Extension<Arc<Guard>>,
    headers: HeaderMap,
    Path(name): Path<String>,
) -> Result<String, Refused> {
    guard.check_origin(&headers)?;
    admitted(&hub, &guard, &headers)?;
    with(&hub, move |recordings| recordings.replay(&name)).await
}

pub(super) async fn delete(
    State(hub): State<Hub>,
    Extension(guard): Extension<Arc<Guard>>,
    headers: HeaderMap,
    Path(name): Path<String>,
    uri: Uri,
) -> Result<(), Refused> {
    guard.check_origin(&headers)?;
    admitted(&hub, &guard, &headers)?;
    if !drives(&hub, &uri) {
        return Err(Refused::NotDriving);
    }
    with(&hub, move |recordings| recordings.delete(&name)).await
}

fn admitted(hub: &Hub, guard: &Guard, headers: &HeaderMap) -> Result<(), Refused> {
    match guard.role_of(bearer(headers))? {
        _ if !hub.local => Err(Refused::Elsewhere),
        Role::Controller => Ok(()),
        Role::Viewer => Err(Denied::Key.into()),
    }
}

fn json(value: &impl Serialize) -> Result<Response, Refused> {
    let text = serde_json::to_string(value).map_err(|_| Refused::Broken)?;
    Ok(([(header::CONTENT_TYPE, "application/json")], text).into_response())
}

/// Works on the files in a thread of its own: STOP does not wait for a disk.
async fn with<T: Send + 'static>(
    hub: &Hub,
    work: impl FnOnce(&Recordings) -> Result<T, RecordingError> + Send + 'static,
) -> Result<T, Refused> {
    let recordings = Arc::clone(hub.recordings.as_ref().ok_or(Refused::None)?);
    let done = tokio::task::spawn_blocking(move || work(&recordings)).await;
    done.map_err(|_| Refused::Broken)?
        .map_err(Refused::Recording)
}
