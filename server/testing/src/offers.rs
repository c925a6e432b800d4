//! A work order of an operator, and the firms it is offered to.

use crate::person::{ApiResponse, Person};
use crate::server::TestServer;
use binnacle_platform::ids::FirmId;
use serde_json::{Value, json};

/// A time on the day after every test begins.
pub const NEXT_DAY: &str = "2026-11-22T13:00:00Z";

/// An operator with a work order for a ship, and firms that work for the operator.
pub struct OfferParties {
    /// The operator's admin.
    pub ada: Person,
    /// Id of the vessel.
    pub vessel: String,
    /// Id of the compass.
    pub compass: String,
    /// The firms, each with its adjuster.
    pub firms: Vec<(FirmId, Person)>,
    /// Id of the order.
    pub order: String,
}

impl OfferParties {
    /// Creates the order, planned but not offered, and this many firms.
    pub async fn planned(server: &TestServer, firms: usize) -> OfferParties {
        let ada = server.admin("ada").await;
        let vessel = ada.create_vessel("Nao").await;
        let vessel = vessel["id"].as_str().unwrap().to_owned();
        let compasses = ada
            .get(&format!("/vessels/{vessel}/compasses"))
            .await
            .good();
        let compass = compasses["items"][0]["id"].as_str().unwrap().to_owned();
        let mut parties = OfferParties {
            ada,
            vessel,
            compass,
            firms: Vec::new(),
            order: String::new(),
        };
        for name in ["rosa", "juan", "pepa"].into_iter().take(firms) {
            parties.firms.push(parties.ada.adjuster(server, name).await);
        }
        let made = parties
            .ada
            .post("/work-orders", &parties.new_order())
            .await
            .good();
        assert_eq!(made["has_binnacle"], false);
        made["id"].as_str().unwrap().clone_into(&mut parties.order);
        parties
    }

    /// Creates the order and offers it to this many firms, each with an hour to respond.
    pub async fn offered(server: &TestServer, firms: usize) -> OfferParties {
        let parties = OfferParties::planned(server, firms).await;
        parties
            .post(&parties.ada, "/offer", &parties.offer())
            .await
            .good();
        parties
    }

    /// Returns the body of a new order.
    pub fn new_order(&self) -> Value {
        json!({
            "vessel_id": self.vessel, "compass_id": self.compass, "port": "Bilbao",
            "berth": "A5", "planned_at": "2026-11-22T08:00:00Z",
        })
    }

    /// Returns the body of an offer to all firms, one after another.
    pub fn offer(&self) -> Value {
        let ids: Vec<String> = self.firms.iter().map(|(id, _)| id.to_string()).collect();
        json!({ "firms": ids, "answer_within_hours": 1 })
    }

    /// Returns a path below the order.
    pub fn path(&self, rest: &str) -> String {
        format!("/work-orders/{}{rest}", self.order)
    }

    /// Posts to a path below the order.
    pub async fn post(&self, who: &Person, rest: &str, body: &Value) -> ApiResponse {
        who.post(&self.path(rest), body).await
    }

    /// Returns the order as the operator sees it.
    pub async fn view_order(&self) -> Value {
        self.ada.get(&self.path("")).await.good()
    }

    /// Returns the kinds of the log entries that a person sees; `-` where one is withheld.
    pub async fn kinds(&self, who: &Person) -> Vec<String> {
        let log = who.get(&self.path("/entries")).await.good();
        let entries = log["items"].as_array().unwrap().iter();
        let kind = |line: &Value| line["entry"]["kind"].as_str().unwrap_or("-").to_owned();
        entries.map(kind).collect()
    }

    /// Returns the states of the offers, in order.
    pub async fn offers(&self) -> Vec<String> {
        let order = self.view_order().await;
        let offers = order["offers"].as_array().unwrap().iter();
        offers
            .map(|offer| offer["state"].as_str().unwrap().to_owned())
            .collect()
    }
}

/// Returns the body of a proposal: other hours, berth and fee.
pub fn proposal() -> Value {
    json!({
        "terms": { "planned_at": NEXT_DAY, "planned_until": "2026-11-22T17:00:00Z", "berth": "A7",
                   "fee_eur": 900.5 },
        "text": "Our team is at Santander until noon.",
    })
}
