//! Receivers of messages that take a call and do not answer.

use crate::on_both;
use crate::support::Shore;
use crate::webhooks::{Receiver, deliver, make, path};
use binnacle_platform::audit::RequestContext;
use binnacle_platform::ids::{DeliveryId, OrderId};
use binnacle_platform::outbound::Reach;
use binnacle_platform::outbox::{self, Kind, Message, Sent};
use binnacle_platform::webhooks::Sender;
use serde_json::json;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::mpsc;
use tokio::task::JoinHandle;

on_both!(
    receivers_that_do_not_answer_keep_no_other_operators_waiting,
    a_receiver_that_does_not_answer_is_called_upon_once_at_a_time,
);

/// A program that hears of connections and answers none of them until it is told to hang up.
struct Silent {
    heard: mpsc::Receiver<TcpStream>,
    kept: Vec<TcpStream>,
}

impl Silent {
    async fn start() -> (Silent, String) {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}/hook", listener.local_addr().unwrap());
        let (tell, heard) = mpsc::channel(10);
        tokio::spawn(async move {
            while let Ok((stream, _)) = listener.accept().await {
                if tell.send(stream).await.is_err() {
                    return;
                }
            }
        });
        let kept = Vec::new();
        (Silent { heard, kept }, url)
    }

    /// Waits until someone calls.
    async fn hear(&mut self) {
        let stream = self.heard.recv().await.unwrap();
        self.kept.push(stream);
    }
}

/// Has a worker make one delivery beside the test.
fn begin(shore: &Shore) -> JoinHandle<Option<Sent>> {
    let app = shore.app.clone();
    tokio::spawn(async move {
        let sender = Sender::new(Reach::Anywhere).unwrap();
        outbox::step(&app, &sender).await.unwrap()
    })
}

async fn receivers_that_do_not_answer_keep_no_other_operators_waiting(shore: Shore) {
    let (ada, eve) = (shore.admin("ada").await, shore.admin("eve").await);
    let (mut silent, nowhere) = Silent::start().await;
    for _ in 0..3 {
        let webhook = make(&ada, &nowhere, &["alert.raised"]).await;
        ada.post(&path(&webhook, "/test"), &json!({})).await.good();
    }
    let (receiver, url) = Receiver::start().await;
    let webhook = make(&eve, &url, &["alert.raised"]).await;
    eve.post(&path(&webhook, "/test"), &json!({})).await.good();
    let waiting = [begin(&shore), begin(&shore)];
    for _ in &waiting {
        silent.hear().await;
    }
    // The third of Ada's is not called upon while two of hers hold workers up.
    assert_eq!(deliver(&shore).await, [Sent::Delivered]);
    assert_eq!(receiver.got().len(), 1);
    drop(silent);
    for one in waiting {
        assert_eq!(one.await.unwrap(), Some(Sent::Failed));
    }
    shore.finish().await;
}

async fn a_receiver_that_does_not_answer_is_called_upon_once_at_a_time(shore: Shore) {
    let ada = shore.admin("ada").await;
    let (mut silent, nowhere) = Silent::start().await;
    let webhook = make(&ada, &nowhere, &["order.updated"]).await;
    let receiver = webhook["id"].as_str().unwrap().parse().unwrap();
    // Of two orders: neither has to wait for the other one's turn.
    for _ in 0..2 {
        let message = Message {
            id: DeliveryId::new(),
            kind: Kind::OrderUpdated,
            order: Some(OrderId::new()),
            body: "{}".to_owned(),
        };
        let now = shore.app.clock.now().into();
        let command = RequestContext::of_command(&shore.app.db, "queue", now);
        let queued = outbox::queue_one(&command, receiver, &message, now);
        queued.await.unwrap();
    }
    let first = begin(&shore);
    silent.hear().await;
    assert_eq!(deliver(&shore).await, []);
    drop(silent);
    assert_eq!(first.await.unwrap(), Some(Sent::Failed));
    // Then it is the other's turn.
    assert_eq!(deliver(&shore).await, [Sent::Failed]);
    shore.finish().await;
}
