//! Receivers that accept a connection and do not respond.

use binnacle_orders::work_orders::message_kinds;
use binnacle_platform::audit::RequestContext;
use binnacle_platform::ids::{DeliveryId, OrderId};
use binnacle_platform::outbound::Reach;
use binnacle_platform::outbox::{self, Message, Sent};
use binnacle_platform::webhooks::Sender;
use binnacle_server_testing::TestServer;
use binnacle_server_testing::on_both;
use binnacle_server_testing::webhooks::{Receiver, deliver, make, path};
use serde_json::json;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::mpsc;
use tokio::task::JoinHandle;

on_both!(
    slow_receivers_do_not_delay_other_operators,
    a_slow_receiver_gets_one_delivery_at_a_time,
);

/// A program that accepts connections and does not respond until the test closes them.
struct SilentReceiver {
    connections: mpsc::Receiver<TcpStream>,
    open: Vec<TcpStream>,
}

impl SilentReceiver {
    async fn start() -> (SilentReceiver, String) {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let url = format!("http://{}/hook", listener.local_addr().unwrap());
        let (tell, connections) = mpsc::channel(10);
        tokio::spawn(async move {
            while let Ok((stream, _)) = listener.accept().await {
                if tell.send(stream).await.is_err() {
                    return;
                }
            }
        });
        let open = Vec::new();
        (SilentReceiver { connections, open }, url)
    }

    /// Waits for a connection.
    async fn wait_for_connection(&mut self) {
        let stream = self.connections.recv().await.unwrap();
        self.open.push(stream);
    }
}

/// Runs one delivery in the background.
fn start_delivery(server: &TestServer) -> JoinHandle<Option<Sent>> {
    let app = server.app.clone();
    tokio::spawn(async move {
        let sender = Sender::new(Reach::Anywhere).unwrap();
        outbox::step(&app, &sender).await.unwrap()
    })
}

async fn slow_receivers_do_not_delay_other_operators(server: TestServer) {
    let (ada, eve) = (server.admin("ada").await, server.admin("eve").await);
    let (mut silent, nowhere) = SilentReceiver::start().await;
    for _ in 0..3 {
        let webhook = make(&ada, &nowhere, &["alert.raised"]).await;
        ada.post(&path(&webhook, "/test"), &json!({})).await.good();
    }
    let (receiver, url) = Receiver::start().await;
    let webhook = make(&eve, &url, &["alert.raised"]).await;
    eve.post(&path(&webhook, "/test"), &json!({})).await.good();
    let waiting = [start_delivery(&server), start_delivery(&server)];
    for _ in &waiting {
        silent.wait_for_connection().await;
    }
    // Ada's third delivery waits while two of hers occupy workers.
    assert_eq!(deliver(&server).await, [Sent::Delivered]);
    assert_eq!(receiver.received().len(), 1);
    drop(silent);
    for one in waiting {
        assert_eq!(one.await.unwrap(), Some(Sent::Failed));
    }
    server.finish().await;
}

async fn a_slow_receiver_gets_one_delivery_at_a_time(server: TestServer) {
    let ada = server.admin("ada").await;
    let (mut silent, nowhere) = SilentReceiver::start().await;
    let webhook = make(&ada, &nowhere, &["order.updated"]).await;
    let receiver = webhook["id"].as_str().unwrap().parse().unwrap();
    // They are of two orders, so neither waits for the other.
    for _ in 0..2 {
        let message = Message {
            id: DeliveryId::new(),
            kind: message_kinds::UPDATED,
            about: Some(OrderId::new().0),
            body: "{}".to_owned(),
        };
        let now = server.app.clock.now().into();
        let command = RequestContext::of_command(&server.app.db, "queue", now);
        let queued = outbox::queue_one(&command, receiver, &message, now);
        queued.await.unwrap();
    }
    let first = start_delivery(&server);
    silent.wait_for_connection().await;
    assert_eq!(deliver(&server).await, []);
    drop(silent);
    assert_eq!(first.await.unwrap(), Some(Sent::Failed));
    // Then the other one follows.
    assert_eq!(deliver(&server).await, [Sent::Failed]);
    server.finish().await;
}
