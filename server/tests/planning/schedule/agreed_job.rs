//! A job that a firm has accepted.

use super::offers::{firm, offer};
use super::{due_vessel, enter_port_call, solve};
use binnacle_server_testing::patch;
use binnacle_server_testing::port_calls;
use binnacle_server_testing::{ApiResponse, Person, TestServer};
use serde_json::{Value, json};

/// A ship in Rotterdam from the fourteenth to the fifteenth, and the firm with the job.
pub(super) struct AgreedJob {
    pub(super) ada: Person,
    pub(super) rosa: Person,
    pub(super) firm: String,
    pub(super) nao: Value,
    /// Path of the order.
    pub(super) order: String,
    /// Path of the port call.
    pub(super) call: String,
}

impl AgreedJob {
    pub(super) async fn new(server: &TestServer) -> AgreedJob {
        let ada = server.admin("ada").await;
        let nao = due_vessel(&ada, "Nao").await;
        let call = enter_port_call(&ada, &nao, "NLRTM", 14).await;
        let (firm, rosa) = firm(server, &ada, "rosa").await;
        let plan = solve(&ada).await;
        let order = offer(&ada, &plan, &nao).await;
        rosa.post(&format!("{order}/accept"), &json!({}))
            .await
            .good();
        let id = call["id"].as_str().unwrap();
        let call = format!("{}/{id}", port_calls::path(&nao));
        AgreedJob {
            ada,
            rosa,
            firm,
            nao,
            order,
            call,
        }
    }

    pub(super) async fn move_port_call(&self, eta: &str, etd: &str) {
        let times = json!({ "eta": eta, "etd": etd });
        patch(&self.ada, &self.call, &times).await.good();
    }

    pub(super) async fn view_order(&self) -> Value {
        self.ada.get(&self.order).await.good()
    }

    pub(super) async fn retime(&self, at: &str) -> ApiResponse {
        let asked = json!({ "terms": { "planned_at": at }, "answer_within_hours": 1,
                            "text": "She is late." });
        self.ada
            .post(&format!("{}/retime", self.order), &asked)
            .await
    }

    pub(super) async fn respond(&self, who: &Person, yes: &str) -> ApiResponse {
        who.post(&format!("{}/retime/{yes}", self.order), &json!({}))
            .await
    }
}

/// Returns the messages of an order.
pub(super) async fn messages(person: &Person, order: &str) -> Vec<Value> {
    let list = person.get(&format!("{order}/messages")).await.good();
    list["items"].as_array().unwrap().clone()
}
