//! A folder with a page and logs, such as a sweep's: its page, and a replay of every log that is clicked.
//!
//! For this computer only. The address contains a secret, and the page has no script: no website and no other user
//! reads it. A log is found by its name among those of the folder `logs`; the name never becomes a path.

use crate::door;
use crate::error::ServeError;
use crate::guard::{Guard, Secret};
use crate::recordings::{RecordingError, Recordings};
use crate::serve::{ServeAt, bind, serve_replay};
use axum::Router;
use axum::extract::{Path as Named, Request, State};
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{Html, IntoResponse, Redirect, Response};
use axum::routing::get;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender};

/// The page, and the folder of the logs that it links.
const PAGE: &str = "index.html";
const LOGS: &str = "logs";

/// Sent with every answer: styles and pictures of the page itself, and nothing else.
const HEADERS: [(HeaderName, HeaderValue); 4] = [
    (
        header::CONTENT_SECURITY_POLICY,
        HeaderValue::from_static(
            "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
        ),
    ),
    (
        header::X_CONTENT_TYPE_OPTIONS,
        HeaderValue::from_static("nosniff"),
    ),
    (
        header::REFERRER_POLICY,
        HeaderValue::from_static("no-referrer"),
    ),
    (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
];

/// A folder being served.
#[derive(Debug)]
pub struct Folder {
    url: String,
    opened: Receiver<()>,
    web: std::thread::JoinHandle<()>,
}

impl Folder {
    /// The address to open in a browser.
    #[must_use]
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Returns when the page has been loaded, or when there is nothing to load any more.
    pub fn until_opened(&self) {
        // An error is the end of all that could say so.
        let _ = self.opened.recv();
    }

    /// Returns when the process was asked to end.
    pub fn wait(self) {
        // It cannot panic; if it did, nothing would be left to do.
        let _ = self.web.join();
    }
}

struct Shown {
    page: PathBuf,
    logs: Recordings,
    opened: Sender<()>,
}

/// Serves a folder to this computer until the process is asked to end.
///
/// # Errors
/// [`ServeError`], when the port cannot be opened.
pub fn serve_folder(at: ServeAt, folder: PathBuf) -> Result<Folder, ServeError> {
    let listener = bind(ServeAt::here(at.port))?;
    let start = || -> io::Result<Folder> {
        let at = listener.local_addr()?;
        let (opens, opened) = mpsc::channel();
        let guard = Arc::new(Guard::new(at, opens.clone()).map_err(io::Error::other)?);
        let Secret(secret) = Secret::new().map_err(io::Error::other)?;
        let shown = Arc::new(Shown {
            page: folder.join(PAGE),
            logs: Recordings::new(folder.join(LOGS), serve_replay),
            opened: opens,
        });
        let router = Router::new()
            .route(&format!("/{secret}/"), get(page))
            .route(&format!("/{secret}/{LOGS}/{{name}}"), get(replay))
            .with_state(shown)
            .layer(middleware::from_fn_with_state(guard, admit));
        let web = door::spawn(listener, router, std::future::pending(), || {})?;
        Ok(Folder {
            url: format!("http://{at}/{secret}/"),
            opened,
            web,
        })
    };
    start().map_err(|error| ServeError::Io((at.address, at.port).into(), error))
}

/// Lets a request in, or says why not.
async fn admit(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let mut response = match guard.check_source(request.headers()) {
        Ok(()) => next.run(request).await,
        Err(denied) => denied.into_response(),
    };
    response.headers_mut().extend(HEADERS);
    response
}

async fn page(State(shown): State<Arc<Shown>>) -> Response {
    let place = shown.page.clone();
    let read = tokio::task::spawn_blocking(move || std::fs::read_to_string(place)).await;
    let _ = shown.opened.send(());
    match read {
        Ok(Ok(html)) => Html(html).into_response(),
        _ => (StatusCode::NOT_FOUND, "the folder has no page any more").into_response(),
    }
}

/// Starts the replay of a log, and leads there.
async fn replay(State(shown): State<Arc<Shown>>, Named(name): Named<String>) -> Response {
    let name = name.strip_suffix(".mcap").unwrap_or(&name).to_owned();
    let started = tokio::task::spawn_blocking(move || shown.logs.replay(&name)).await;
    match started {
        Ok(Ok(url)) => Redirect::to(&url).into_response(),
        Ok(Err(error @ RecordingError::Unknown)) => {
            (StatusCode::NOT_FOUND, error.to_string()).into_response()
        }
        Ok(Err(error)) => (StatusCode::CONFLICT, error.to_string()).into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}
