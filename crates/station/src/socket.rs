//! One page's WebSocket: news from the board out, orders in.
//!
//! The two directions do not wait for each other: a page that is slow to read can still stop the robot. A page that
//! sends anything but an order gets the reason and is closed; the robot goes on. A slow page loses samples of plots but
//! gets every event.
//!
//! STOP is accepted from every page, anything else from the page that has control ([`SharedLease`]).

use crate::board::SharedBoard;
use crate::guard::Role;
use crate::lease::{Membership, SharedLease};
use crate::order_sender::{OrderSender, TOO_MANY};
use crate::recordings::Recordings;
use crate::tuning::Tuning;
use crate::wired::Answer;
use axum::body::Bytes;
use axum::extract::ws::{CloseFrame, Message, WebSocket, close_code};
use futures_util::stream::SplitSink;
use futures_util::{Sink, SinkExt, Stream, StreamExt};
use rumbo_log::{Level, LoggedEvent};
use rumbo_session::{Cursor, MAX_ORDER, News, Order, ToPage, WORLD_ORDER};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::time::{interval, sleep, timeout};

/// Most rows sent to a page at once; of more it gets the newest.
const ROWS_AT_ONCE: usize = 500;
/// The same of readings, of which there may be four times as many.
const READINGS_AT_ONCE: usize = 2_000;
/// Refusals that wait for a page.
const REFUSALS_WAITING: usize = 8;
/// News within this time are sent together: a page draws at most 60 times a second.
const GATHER: Duration = Duration::from_millis(15);
/// A page that reads nothing for this long is closed; it reconnects by itself and gets the recent past.
pub(crate) const SEND_TIMEOUT: Duration = Duration::from_secs(5);
/// Interval of the pings, which browsers answer by themselves.
pub(crate) const PING: Duration = Duration::from_secs(5);
/// A page that sends nothing for this long, not even a pong, is gone: its computer sleeps, or the network is cut.
pub(crate) const SILENCE: Duration = Duration::from_secs(15);

/// State shared by all connections.
#[derive(Clone, Debug)]
pub(crate) struct Hub {
    pub(crate) board: Arc<SharedBoard>,
    pub(crate) orders: Arc<OrderSender>,
    pub(crate) lease: SharedLease,
    /// Its number among the robots in its world, and what they are called if there are several.
    pub(crate) robot: usize,
    pub(crate) robots: Arc<[String]>,
    /// Only this computer reaches the pages: they may hand in programs, and see and delete recordings.
    pub(crate) local: bool,
    pub(crate) recordings: Option<Arc<Recordings>>,
    pub(crate) tuning: Option<Arc<Tuning>>,
    pub(crate) wired: Option<Answer>,
}

impl Hub {
    /// Longest message of a page \[bytes\].
    pub(crate) fn longest_message(&self) -> usize {
        match self.local {
            true => MAX_ORDER,
            false => WORLD_ORDER,
        }
    }
}

/// The orders of a page, so that it knows which of them a state has seen.
#[derive(Default)]
struct Given(Mutex<(VecDeque<u64>, u64)>);

impl Given {
    /// An order has this number; one that is refused has none.
    fn note(&self, number: Option<u64>) {
        let mut given = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        given.0.push_back(number.unwrap_or_default());
    }

    /// How many of them are through when the session has taken all up to this number.
    fn through(&self, taken: u64) -> u64 {
        let mut given = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (waiting, through) = &mut *given;
        while waiting.pop_front_if(|number| *number <= taken).is_some() {
            *through += 1;
        }
        *through
    }
}

/// Why a connection ends.
struct Closing {
    code: u16,
    text: String,
}

/// Serves one page until either side ends it.
pub(crate) async fn talk(socket: WebSocket, hub: Hub, role: Role) {
    let (mut out, mut from_page) = socket.split();
    let closing = match hub.lease.join(role == Role::Controller) {
        Some(place) => {
            let (refuse, refusals) = mpsc::channel(REFUSALS_WAITING);
            let given = Given::default();
            // Control goes with the page's place, however long closing takes.
            tokio::select! {
                closing = publish_news(&mut out, &hub, &place, &given, refusals) => closing,
                closing = take_orders(&mut from_page, &hub, &place, &given, &refuse) => closing,
            }
        }
        None => Some(Closing {
            code: close_code::AGAIN,
            text: "too many pages are open: close some of them".into(),
        }),
    };
    if let Some(closing) = closing {
        // The page may be gone; then nobody needs to know.
        let _ = timeout(SEND_TIMEOUT, async {
            close(&mut out, closing).await?;
            // A connection with unread bytes would be reset, and the reason lost on its way.
            while let Some(Ok(_)) = from_page.next().await {}
            Ok::<(), axum::Error>(())
        })
        .await;
    }
}

async fn close(
    out: &mut SplitSink<WebSocket, Message>,
    closing: Closing,
) -> Result<(), axum::Error> {
    let text = &closing.text;
    if let Some(text) = (ToPage::Error { text }).json() {
        out.send(Message::Text(text.into())).await?;
    }
    // A close frame has room for 123 bytes.
    let reason: String = closing
        .text
        .chars()
        .filter(char::is_ascii)
        .take(123)
        .collect();
    out.send(Message::Close(Some(CloseFrame {
        code: closing.code,
        reason: reason.into(),
    })))
    .await
}

/// Ends when the page closes, sends anything but an order, or falls silent.
async fn take_orders(
    mut from_page: impl Stream<Item = Result<Message, axum::Error>> + Unpin,
    hub: &Hub,
    place: &Membership,
    given: &Given,
    refuse: &mpsc::Sender<&'static str>,
) -> Option<Closing> {
    // After a silence nobody is left to read the reason.
    while let Ok(Some(Ok(message))) = timeout(SILENCE, from_page.next()).await {
        let text = match message {
            Message::Text(text) => text,
            Message::Binary(_) => {
                return Some(Closing {
                    code: close_code::UNSUPPORTED,
                    text: "not understood: binary message".into(),
                });
            }
            Message::Close(_) => return None,
            Message::Ping(_) | Message::Pong(_) => continue,
        };
        let order = match text.parse::<Order>() {
            Ok(order) => order,
            Err(error) => {
                return Some(Closing {
                    code: close_code::POLICY,
                    text: error.to_string(),
                });
            }
        };
        let admitted = match order {
            Order::Program(_) | Order::Sketch(..) | Order::Debug(_) if !hub.local => Err(
                "refused: programs are taken and shown only where no other computer reaches the page",
            ),
            _ => place.admit(&order),
        };
        if let Err(why) = admitted {
            // A page need not read each of many refusals.
            let _ = refuse.try_send(why);
            given.note(None);
            continue;
        }
        let Ok(number) = hub.orders.send(order) else {
            return Some(Closing {
                code: close_code::AGAIN,
                text: TOO_MANY.into(),
            });
        };
        given.note(Some(number));
    }
    None
}

/// Ends when nothing can be sent to the page any more.
async fn publish_news(
    out: &mut (impl Sink<Message> + Unpin),
    hub: &Hub,
    place: &Membership,
    given: &Given,
    mut refusals: mpsc::Receiver<&'static str>,
) -> Option<Closing> {
    let (mut changed, mut moved) = (hub.board.subscribe(), hub.lease.subscribe());
    let mut cursor = Cursor::default();
    send(out, &ToPage::hello(&hub.robots, hub.robot)).await?;
    let (mut shown, mut run, mut t_s) = (None, 0, 0.0);
    let mut pings = interval(PING);
    loop {
        let view = place.view();
        if shown.replace(view) != Some(view) {
            send(out, &ToPage::Control(view)).await?;
        }
        let (mut news, taken) = hub.board.news(&mut cursor);
        news.orders = given.through(taken);
        if news.events_gone > 0 {
            return Some(Closing {
                code: close_code::AGAIN,
                text: "too slow: events were missed".into(),
            });
        }
        // A page behind within a run continues with the newest.
        let behind = news.samples.len().saturating_sub(ROWS_AT_ONCE);
        if std::mem::replace(&mut run, news.run) == news.run {
            news.samples.drain(..behind);
            let behind = news.readings.len().saturating_sub(READINGS_AT_ONCE);
            news.readings.drain(..behind);
        }
        t_s = news.state.as_ref().map_or(t_s, |state| state.t_s);
        while let Ok(text) = refusals.try_recv() {
            news.events.push(LoggedEvent {
                t_s,
                level: Level::Warning,
                text: text.into(),
            });
        }
        send_news(out, news).await?;
        sleep(GATHER).await;
        tokio::select! {
            changed = changed.changed() => changed.ok()?,
            moved = moved.changed() => moved.ok()?,
            _ = pings.tick() => put(out, Message::Ping(Bytes::new())).await?,
            Some(text) = refusals.recv() => {
                let events = [LoggedEvent { t_s, level: Level::Warning, text: text.into() }];
                send(out, &ToPage::Events { events: &events }).await?;
            }
        }
    }
}

async fn send_news(out: &mut (impl Sink<Message> + Unpin), news: News) -> Option<()> {
    for message in news.messages() {
        send(out, &message).await?;
    }
    Some(())
}

async fn send(out: &mut (impl Sink<Message> + Unpin), message: &ToPage<'_>) -> Option<()> {
    let text = message.json()?;
    put(out, Message::Text(text.into())).await
}

async fn put(out: &mut (impl Sink<Message> + Unpin), message: Message) -> Option<()> {
    timeout(SEND_TIMEOUT, out.send(message)).await.ok()?.ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures_util::sink::unfold;
    use futures_util::stream::poll_fn;
    use rumbo_log::{Entry, Row};
    use std::future::ready;

    fn hub() -> Hub {
        Hub {
            board: Arc::new(SharedBoard::default()),
            orders: Arc::new(OrderSender::of(1).remove(0).0),
            lease: SharedLease::default(),
            robot: 0,
            robots: Arc::default(),
            local: true,
            recordings: None,
            tuning: None,
            wired: None,
        }
    }

    /// A connection to a page with room for one message, like one with full buffers.
    fn connection() -> (impl Sink<Message> + Unpin, mpsc::Receiver<Message>) {
        let (to_page, page) = mpsc::channel(1);
        let send = |to_page: mpsc::Sender<Message>, message| async move {
            to_page.send(message).await.map(|()| to_page)
        };
        (Box::pin(unfold(to_page, send)), page)
    }

    #[tokio::test(start_paused = true)]
    async fn a_page_that_answers_no_ping_is_given_up_and_one_that_does_is_not() {
        let hub = hub();
        let place = hub.lease.join(true).unwrap();
        let (refuse, refusals) = mpsc::channel(1);
        let given = Given::default();
        let (mut out, mut page) = connection();
        let begun = tokio::time::Instant::now();
        // It answers ten pings, then none.
        let answers = poll_fn(|context| page.poll_recv(context))
            .filter(|message| ready(matches!(message, Message::Ping(_))))
            .enumerate()
            .filter_map(|(ping, _)| ready((ping < 10).then(|| Ok(Message::Pong(Bytes::new())))));
        let closing = tokio::select! {
            _ = publish_news(&mut out, &hub, &place, &given, refusals) => panic!("the page takes all"),
            closing = take_orders(Box::pin(answers), &hub, &place, &given, &refuse) => closing,
        };
        assert!(closing.is_none());
        let lasted = begun.elapsed();
        assert!(
            lasted >= 9 * PING + SILENCE && lasted < 10 * PING + SILENCE,
            "{lasted:?}"
        );
    }

    #[tokio::test]
    async fn a_page_that_reads_nothing_for_a_while_loses_samples_but_no_event() {
        const ROUNDS: usize = 300;
        let hub = hub();
        let board = Arc::clone(&hub.board);
        let place = hub.lease.join(true).unwrap();
        let (mut out, mut page) = connection();
        let (_refuse, refusals) = mpsc::channel(1);
        let given = Given::default();
        let reader = async {
            for round in 0..ROUNDS {
                let rows: Vec<Row> = (0..100)
                    .map(|row| Row::unknown((100 * round + row) as i64))
                    .collect();
                board.take(&Entry::Rows(rows).into());
                let event = LoggedEvent {
                    t_s: 0.0,
                    level: Level::Info,
                    text: round.to_string(),
                };
                board.take(&Entry::Event(event).into());
                tokio::task::yield_now().await;
            }
            let (mut events, mut rows, mut last_s) = (Vec::new(), 0, 0.0);
            while events.len() < ROUNDS || last_s < (100 * ROUNDS - 1) as f64 / 1e3 {
                let text = match page.recv().await {
                    Some(Message::Text(text)) => text,
                    Some(Message::Ping(_)) => continue,
                    gone => panic!("the page was given up: {gone:?}"),
                };
                let message: serde_json::Value = serde_json::from_str(&text).unwrap();
                for event in message["events"].as_array().into_iter().flatten() {
                    events.push(event["text"].as_str().unwrap().to_owned());
                }
                for row in message["rows"].as_array().into_iter().flatten() {
                    rows += 1;
                    last_s = row[0].as_f64().unwrap();
                }
            }
            (events, rows)
        };
        let (events, rows) = tokio::select! {
            _ = publish_news(&mut out, &hub, &place, &given, refusals) => panic!("the page was given up"),
            read = reader => read,
        };
        assert!(
            events
                .iter()
                .map(|text| text.parse::<usize>().unwrap())
                .eq(0..ROUNDS)
        );
        assert!(rows < 100 * ROUNDS, "{rows}");
    }
}
