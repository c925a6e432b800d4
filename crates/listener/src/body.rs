//! Bodies that note for whom they wait.

use crate::turns::{PIECE_BYTES, Turn};
use axum::BoxError;
use axum::body::{Body, Bytes, HttpBody};
use http_body::{Frame, SizeHint};
use hyper::body::Incoming;
use std::pin::Pin;
use std::task::{Context, Poll, ready};

/// Body of a request: while the handler has asked for more, it waits for the peer.
#[derive(Debug)]
pub(crate) struct RequestBody {
    body: Incoming,
    turn: Turn,
}

impl RequestBody {
    pub(crate) fn new(body: Incoming, turn: Turn) -> RequestBody {
        RequestBody { body, turn }
    }
}

impl HttpBody for RequestBody {
    type Data = Bytes;
    type Error = hyper::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, hyper::Error>>> {
        let polled = Pin::new(&mut self.body).poll_frame(cx);
        match &polled {
            Poll::Pending => self.turn.wait_for_peer(),
            Poll::Ready(frame) => {
                let data = frame.as_ref().and_then(|frame| frame.as_ref().ok());
                let data = data.and_then(Frame::data_ref);
                self.turn.take_back(data.map_or(0, Bytes::len));
            }
        }
        polled
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

/// Body of a response, handed over in pieces: it waits for the peer from one piece until it is
/// asked for the next.
#[derive(Debug)]
pub(crate) struct ResponseBody {
    body: Body,
    /// Data that was not handed over yet.
    rest: Bytes,
    /// Size of the last piece, bytes.
    handed_over: usize,
    turn: Turn,
}

impl ResponseBody {
    pub(crate) fn new(body: Body, turn: Turn) -> ResponseBody {
        ResponseBody {
            body,
            rest: Bytes::new(),
            handed_over: 0,
            turn,
        }
    }

    fn next_piece(&mut self) -> Bytes {
        let piece = self.rest.split_to(self.rest.len().min(PIECE_BYTES));
        self.handed_over = piece.len();
        self.turn.wait_for_peer();
        piece
    }
}

impl HttpBody for ResponseBody {
    type Data = Bytes;
    type Error = BoxError;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, BoxError>>> {
        let handed_over = self.handed_over;
        self.turn.take_back(handed_over);
        if !self.rest.is_empty() {
            return Poll::Ready(Some(Ok(Frame::data(self.next_piece()))));
        }
        let Some(frame) = ready!(Pin::new(&mut self.body).poll_frame(cx)?) else {
            return Poll::Ready(None);
        };
        Poll::Ready(Some(Ok(match frame.into_data() {
            Ok(data) => {
                self.rest = data;
                Frame::data(self.next_piece())
            }
            Err(trailers) => {
                self.turn.wait_for_peer();
                trailers
            }
        })))
    }

    fn is_end_stream(&self) -> bool {
        self.rest.is_empty() && self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        let rest = self.rest.len() as u64;
        let body = self.body.size_hint();
        let mut hint = SizeHint::new();
        hint.set_lower(body.lower() + rest);
        if let Some(upper) = body.upper() {
            hint.set_upper(upper + rest);
        }
        hint
    }
}
