//! Work orders between an operator and firms: offered, answered, carried to the ship.

mod forbidden;
mod races;
mod told;
mod way;

use crate::on_both;
use crate::support::{Answer, Person, Shore};
use binnacle_orders::dispatch::lapse;
use binnacle_platform::ids::FirmId;
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_firm_accepts_and_goes_on_board,
    the_next_firm_is_asked_when_one_declines_or_is_silent,
    silence_leaves_the_next_firms_time_before_the_job,
    nobody_is_asked_for_a_job_whose_time_is_over,
    a_firm_that_wants_to_be_asked_earlier_is_passed_over,
    a_firm_proposes_other_terms_and_the_operator_agrees,
    terms_that_the_operator_does_not_want_go_to_the_next_firm,
    a_proposal_that_nobody_answers_lapses,
    a_firm_gives_an_order_back,
    messages_are_between_the_operator_and_one_firm,
    an_offer_that_makes_no_sense_is_refused_whole,
);

pub(crate) const HOUR_S: f64 = 3600.0;
/// 2026-11-22T13:00:00Z: the day after every test begins.
const NEXT_DAY: &str = "2026-11-22T13:00:00Z";

/// An operator with a ship, and firms that work for it.
pub(crate) struct Trade {
    pub(crate) ada: Person,
    pub(crate) vessel: String,
    pub(crate) compass: String,
    pub(crate) firms: Vec<(FirmId, Person)>,
    pub(crate) order: String,
}

impl Trade {
    /// With so many firms, the order planned but not offered.
    pub(crate) async fn planned(shore: &Shore, firms: usize) -> Trade {
        let ada = shore.admin("ada").await;
        let vessel = ada.create_vessel("Nao").await;
        let vessel = vessel["id"].as_str().unwrap().to_owned();
        let compasses = ada
            .get(&format!("/vessels/{vessel}/compasses"))
            .await
            .good();
        let compass = compasses["items"][0]["id"].as_str().unwrap().to_owned();
        let mut trade = Trade {
            ada,
            vessel,
            compass,
            firms: Vec::new(),
            order: String::new(),
        };
        for name in ["rosa", "juan", "pepa"].into_iter().take(firms) {
            trade.firms.push(trade.ada.adjuster(shore, name).await);
        }
        let made = trade
            .ada
            .post("/work-orders", &trade.new_order())
            .await
            .good();
        assert_eq!(made["has_binnacle"], false);
        made["id"].as_str().unwrap().clone_into(&mut trade.order);
        trade
    }

    /// With so many firms, offered to them, each with an hour to answer.
    pub(crate) async fn offered(shore: &Shore, firms: usize) -> Trade {
        let trade = Trade::planned(shore, firms).await;
        trade
            .post(&trade.ada, "/offer", &trade.offer())
            .await
            .good();
        trade
    }

    pub(crate) fn new_order(&self) -> Value {
        json!({
            "vessel_id": self.vessel, "compass_id": self.compass, "port": "Bilbao",
            "berth": "A5", "planned_at": "2026-11-22T08:00:00Z",
        })
    }

    pub(crate) fn offer(&self) -> Value {
        let ids: Vec<String> = self.firms.iter().map(|(id, _)| id.to_string()).collect();
        json!({ "firms": ids, "answer_within_hours": 1 })
    }

    pub(crate) fn path(&self, rest: &str) -> String {
        format!("/work-orders/{}{rest}", self.order)
    }

    pub(crate) async fn post(&self, who: &Person, rest: &str, body: &Value) -> Answer {
        who.post(&self.path(rest), body).await
    }

    pub(crate) async fn seen(&self) -> Value {
        self.ada.get(&self.path("")).await.good()
    }

    /// The kinds of the entries of the log, as someone reads it; `-` where one is withheld.
    pub(crate) async fn kinds(&self, who: &Person) -> Vec<String> {
        let log = who.get(&self.path("/entries")).await.good();
        let entries = log["items"].as_array().unwrap().iter();
        let kind = |line: &Value| line["entry"]["kind"].as_str().unwrap_or("-").to_owned();
        entries.map(kind).collect()
    }

    /// How the offers stand, in order.
    pub(crate) async fn offers(&self) -> Vec<String> {
        let order = self.seen().await;
        let offers = order["offers"].as_array().unwrap().iter();
        offers
            .map(|offer| offer["state"].as_str().unwrap().to_owned())
            .collect()
    }
}

async fn a_firm_accepts_and_goes_on_board(shore: Shore) {
    let trade = Trade::offered(&shore, 1).await;
    let (firm, rosa) = &trade.firms[0];
    let (_, other) = shore.admin("eve").await.adjuster(&shore, "other").await;
    let offered = trade.seen().await;
    assert_eq!(offered["state"], "offered");
    assert_eq!(offered["firm_id"], Value::Null);
    assert_eq!(offered["answer_by"], "2026-11-21T08:00:00Z");
    let listed = rosa.get("/work-orders?state=offered").await.good();
    assert_eq!(listed["items"][0]["id"], trade.order.as_str());
    assert_eq!(listed["items"][0]["operator_name"], "ada");
    assert_eq!(
        rosa.get("/work-orders?state=planned").await.good()["items"],
        json!([])
    );
    assert_eq!(other.get("/work-orders").await.good()["items"], json!([]));
    assert_eq!(other.get(&trade.path("")).await.problem(), "not-found");
    let refused = trade.post(&other, "/accept", &json!({})).await;
    assert_eq!(refused.problem(), "not-found");

    let early = trade.post(rosa, "/on-board", &json!({})).await;
    assert_eq!(early.problem(), "wrong-state");
    let who = json!({ "adjuster_name": "M. Etxeberria", "adjuster_licence": "ES-CA-114" });
    let accepted = trade.post(rosa, "/accept", &who).await.good();
    assert_eq!(accepted["state"], "accepted");
    assert_eq!(accepted["firm_id"], firm.to_string());
    assert_eq!(accepted["firm"], "rosa");
    assert_eq!(accepted["adjuster_name"], "M. Etxeberria");
    assert_eq!(accepted["answer_by"], Value::Null);
    let aboard = trade.post(rosa, "/on-board", &json!({})).await.good();
    assert_eq!(aboard["state"], "on_board");
    let all = ["opened", "offered", "asked", "accepted", "on_board"];
    assert_eq!(trade.kinds(&trade.ada).await, all);
    let theirs = ["opened", "-", "asked", "accepted", "on_board"];
    assert_eq!(trade.kinds(rosa).await, theirs);
    shore.finish().await;
}

async fn the_next_firm_is_asked_when_one_declines_or_is_silent(shore: Shore) {
    let trade = Trade::offered(&shore, 3).await;
    let [(_, rosa), (_, juan), (_, pepa)] = &trade.firms[..] else {
        unreachable!("there are three")
    };
    assert_eq!(trade.offers().await, ["open", "waiting", "waiting"]);
    assert_eq!(juan.get(&trade.path("")).await.problem(), "not-found");
    let early = trade.post(juan, "/accept", &json!({})).await;
    assert_eq!(early.problem(), "not-found");
    let no = trade
        .post(rosa, "/decline", &json!({ "text": "No team." }))
        .await;
    assert_eq!(no.status, 204, "{no:?}");
    assert_eq!(trade.offers().await, ["declined", "open", "waiting"]);
    assert_eq!(rosa.get(&trade.path("")).await.problem(), "not-found");
    let again = trade.post(rosa, "/accept", &json!({})).await;
    assert_eq!(again.problem(), "wrong-state");
    assert!(again.text.contains("declined"), "{again:?}");

    assert_eq!(lapse(&shore.app).await.unwrap(), 0);
    shore.advance(HOUR_S + 1.0);
    let late = trade.post(juan, "/accept", &json!({})).await;
    assert_eq!(late.problem(), "wrong-state");
    assert!(late.text.contains("lapsed"), "{late:?}");
    assert_eq!(lapse(&shore.app).await.unwrap(), 1);
    assert_eq!(trade.offers().await, ["declined", "lapsed", "open"]);
    let later = trade.post(juan, "/accept", &json!({})).await;
    assert!(later.text.contains("lapsed"), "{later:?}");
    assert_eq!(trade.seen().await["answer_by"], "2026-11-21T09:00:01Z");
    shore.advance(HOUR_S + 1.0);
    assert_eq!(lapse(&shore.app).await.unwrap(), 1);
    assert_eq!(trade.seen().await["state"], "declined");
    assert_eq!(pepa.get("/work-orders").await.good()["items"], json!([]));

    // It is offered again, also to who was silent.
    let again = json!({ "firms": [trade.firms[1].0], "text": "Please." });
    trade.post(&trade.ada, "/offer", &again).await.good();
    assert_eq!(trade.offers().await, ["declined", "lapsed", "open"]);
    let taken = trade.post(juan, "/accept", &json!({})).await.good();
    assert_eq!(taken["offers"].as_array().unwrap().len(), 1, "{taken}");
    shore.finish().await;
}

/// The job is in 25 hours; each firm could have two days.
async fn silence_leaves_the_next_firms_time_before_the_job(shore: Shore) {
    let trade = Trade::planned(&shore, 3).await;
    let mut offer = trade.offer();
    offer["answer_within_hours"] = json!(48);
    trade.post(&trade.ada, "/offer", &offer).await.good();
    assert_eq!(trade.seen().await["answer_by"], "2026-11-21T15:20:00Z");
    shore.advance(8.0 * HOUR_S + 1201.0);
    assert_eq!(lapse(&shore.app).await.unwrap(), 1);
    assert_eq!(trade.offers().await, ["lapsed", "open", "waiting"]);
    assert_eq!(trade.seen().await["answer_by"], "2026-11-21T23:40:00Z");
    // What a firm proposes is answered in time for the third.
    let juan = &trade.firms[1].1;
    trade.post(juan, "/propose", &proposal()).await.good();
    assert_eq!(trade.seen().await["answer_by"], "2026-11-21T23:40:00Z");
    trade.post(&trade.ada, "/decline", &json!({})).await;
    assert_eq!(trade.offers().await, ["lapsed", "declined", "open"]);
    assert_eq!(trade.seen().await["answer_by"], "2026-11-22T08:00:00Z");
    shore.finish().await;
}

async fn nobody_is_asked_for_a_job_whose_time_is_over(shore: Shore) {
    let mut trade = Trade::planned(&shore, 2).await;
    let cancel = json!({ "text": "another time" });
    trade.post(&trade.ada, "/cancel", &cancel).await.good();
    let mut new = trade.new_order();
    new["planned_at"] = json!("2026-11-21T09:00:00Z");
    new["offer"] = trade.offer();
    let made = trade.ada.post("/work-orders", &new).await.good();
    made["id"].as_str().unwrap().clone_into(&mut trade.order);
    let [(_, rosa), (_, juan)] = &trade.firms[..] else {
        unreachable!("there are two")
    };
    trade.post(rosa, "/accept", &json!({})).await.good();
    shore.advance(2.0 * HOUR_S + 1.0);
    let back = trade.post(rosa, "/decline", &json!({})).await;
    assert_eq!(back.status, 204, "{back:?}");
    assert_eq!(trade.offers().await, ["declined", "lapsed"]);
    let order = trade.seen().await;
    assert_eq!(order["state"], "declined");
    assert_eq!(
        order["offers"][1]["text"],
        "not asked: the time of the job is past"
    );
    let refused = trade.post(juan, "/accept", &json!({})).await;
    assert!(refused.status >= 400, "{refused:?}");
    shore.advance(HOUR_S);
    let late = trade.post(&trade.ada, "/offer", &trade.offer()).await;
    assert_eq!(late.problem(), "wrong-state");
    assert!(
        late.text.contains("2026-11-21 09:00 UTC, which is past"),
        "{late:?}"
    );
    shore.finish().await;
}

/// Juan wants to be asked a day ahead, and Pepa five hours.
async fn a_firm_that_wants_to_be_asked_earlier_is_passed_over(shore: Shore) {
    let trade = Trade::planned(&shore, 3).await;
    for (firm, hours) in [(&trade.firms[1].0, 24), (&trade.firms[2].0, 5)] {
        let terms = json!({ "fee_eur": 1800, "working_days": ["Sun"], "lead_time_h": hours });
        let path = format!("/firms/{firm}/terms");
        let put = trade.ada.request(Method::PUT, &path).json(&terms);
        Answer::of(put).await.good();
    }
    let mut offer = trade.offer();
    offer["answer_within_hours"] = json!(48);
    trade.post(&trade.ada, "/offer", &offer).await.good();
    // Half of the hour until Juan is to be asked.
    assert_eq!(trade.seen().await["answer_by"], "2026-11-21T07:30:00Z");
    shore.advance(2.0 * HOUR_S);
    assert_eq!(lapse(&shore.app).await.unwrap(), 1);
    assert_eq!(trade.offers().await, ["lapsed", "lapsed", "open"]);
    let passed = &trade.seen().await["offers"][1];
    assert_eq!(passed["text"], "not asked: it requires 24 h notice");
    shore.finish().await;
}

fn proposal() -> Value {
    json!({
        "terms": { "planned_at": NEXT_DAY, "berth": "A7", "fee_eur": 900.5 },
        "text": "Our team is at Santander until noon.",
    })
}

async fn a_firm_proposes_other_terms_and_the_operator_agrees(shore: Shore) {
    let trade = Trade::offered(&shore, 2).await;
    let (_, rosa) = &trade.firms[0];
    let proposed = trade.post(rosa, "/propose", &proposal()).await.good();
    assert_eq!(proposed["state"], "proposed");
    let seen = trade.seen().await;
    assert_eq!(seen["offers"][0]["terms"], proposal()["terms"]);
    assert_eq!(seen["planned_at"], "2026-11-22T08:00:00Z");
    let own = trade.post(rosa, "/accept", &json!({})).await;
    assert_eq!(own.problem(), "wrong-state");
    let agreed = trade.post(&trade.ada, "/accept", &json!({})).await.good();
    assert_eq!(agreed["state"], "accepted");
    assert_eq!(agreed["planned_at"], NEXT_DAY);
    assert_eq!(agreed["berth"], "A7", "{agreed}");
    assert_eq!(agreed["firm"], "rosa");
    let again = trade.post(&trade.ada, "/accept", &json!({})).await;
    assert_eq!(again.problem(), "wrong-state");
    shore.finish().await;
}

async fn terms_that_the_operator_does_not_want_go_to_the_next_firm(shore: Shore) {
    let trade = Trade::offered(&shore, 2).await;
    trade
        .post(&trade.firms[0].1, "/propose", &proposal())
        .await
        .good();
    let no = trade
        .post(&trade.ada, "/decline", &json!({ "text": "Too late." }))
        .await;
    assert_eq!(no.status, 204, "{no:?}");
    assert_eq!(trade.offers().await, ["declined", "open"]);
    let past = json!({ "terms": { "planned_at": "2026-11-20T00:00:00Z" } });
    let refused = trade.post(&trade.firms[1].1, "/propose", &past).await;
    assert_eq!(refused.problem(), "invalid");
    let paid = json!({ "terms": { "planned_at": NEXT_DAY, "fee_eur": -1.0 } });
    let refused = trade.post(&trade.firms[1].1, "/propose", &paid).await;
    assert_eq!(refused.problem(), "invalid");
    assert_eq!(trade.offers().await, ["declined", "open"]);
    shore.finish().await;
}

async fn a_proposal_that_nobody_answers_lapses(shore: Shore) {
    let trade = Trade::offered(&shore, 1).await;
    shore.advance(HOUR_S / 2.0);
    trade
        .post(&trade.firms[0].1, "/propose", &proposal())
        .await
        .good();
    shore.advance(HOUR_S / 2.0 + 1.0);
    // The operator has an hour of its own.
    assert_eq!(lapse(&shore.app).await.unwrap(), 0);
    shore.advance(HOUR_S / 2.0);
    let late = trade.post(&trade.ada, "/accept", &json!({})).await;
    assert_eq!(late.problem(), "wrong-state");
    assert_eq!(lapse(&shore.app).await.unwrap(), 1);
    assert_eq!(trade.offers().await, ["lapsed"]);
    assert_eq!(trade.seen().await["state"], "declined");
    shore.finish().await;
}

async fn a_firm_gives_an_order_back(shore: Shore) {
    let trade = Trade::offered(&shore, 2).await;
    let [(_, rosa), (_, juan)] = &trade.firms[..] else {
        unreachable!("there are two")
    };
    let who = json!({ "adjuster_name": "M. Etxeberria" });
    trade.post(rosa, "/accept", &who).await.good();
    let back = trade
        .post(rosa, "/decline", &json!({ "text": "Ill." }))
        .await;
    assert_eq!(back.status, 204, "{back:?}");
    let order = trade.seen().await;
    assert_eq!(order["state"], "offered");
    for field in ["firm", "firm_id", "adjuster_name"] {
        assert_eq!(order[field], Value::Null, "{field}");
    }
    trade.post(juan, "/accept", &json!({})).await.good();
    trade.post(juan, "/on-board", &json!({})).await.good();
    let late = trade.post(juan, "/decline", &json!({})).await;
    assert_eq!(late.problem(), "wrong-state");
    shore.finish().await;
}

async fn messages_are_between_the_operator_and_one_firm(shore: Shore) {
    let trade = Trade::planned(&shore, 2).await;
    let [(rosas, rosa), (_, juan)] = &trade.firms[..] else {
        unreachable!("there are two")
    };
    let mut offer = trade.offer();
    offer["at_once"] = json!(true);
    let nobody = trade
        .post(&trade.ada, "/messages", &json!({ "text": "?" }))
        .await;
    assert_eq!(nobody.problem(), "wrong-state");
    trade.post(&trade.ada, "/offer", &offer).await.good();
    let which = trade
        .post(&trade.ada, "/messages", &json!({ "text": "?" }))
        .await;
    assert_eq!(which.problem(), "invalid");
    let asked = json!({ "text": "Is the gangway to port?\nOr to starboard?" });
    let sent = trade.post(rosa, "/messages", &asked).await;
    assert_eq!(sent.status, 204, "{sent:?}");
    let answer = json!({ "firm_id": rosas, "text": "To port." });
    let sent = trade.post(&trade.ada, "/messages", &answer).await;
    assert_eq!(sent.status, 204, "{sent:?}");
    for (who, expected) in [(&trade.ada, 2), (rosa, 2), (juan, 0)] {
        let read = who.get(&trade.path("/messages")).await.good();
        let items = read["items"].as_array().unwrap();
        assert_eq!(items.len(), expected);
        if let [first, second] = &items[..] {
            assert_eq!(
                (&first["text"], &first["from_firm"]),
                (&asked["text"], &json!(true))
            );
            assert_eq!(
                (&second["text"], &second["from_firm"]),
                (&json!("To port."), &json!(false))
            );
        }
    }
    let kinds = trade.kinds(juan).await;
    assert_eq!(kinds, ["opened", "-", "-", "asked", "-", "-"]);
    let blank = trade.post(rosa, "/messages", &json!({ "text": " " })).await;
    assert_eq!(blank.problem(), "invalid");
    shore.finish().await;
}

async fn an_offer_that_makes_no_sense_is_refused_whole(shore: Shore) {
    let trade = Trade::planned(&shore, 1).await;
    let eve = shore.admin("eve").await;
    let (strange, _) = eve.adjuster(&shore, "other").await;
    let rosas = trade.firms[0].0;
    for bad in [
        json!({ "firms": [] }),
        json!({ "firms": [rosas, rosas] }),
        json!({ "firms": [strange] }),
        json!({ "firms": [rosas], "answer_within_hours": 0 }),
        json!({ "firms": [rosas], "answer_within_hours": 721 }),
        json!({ "firms": [rosas], "by": "pigeon" }),
    ] {
        let refused = trade.post(&trade.ada, "/offer", &bad).await;
        assert_eq!(refused.problem(), "invalid", "{bad}");
    }
    assert_eq!(trade.kinds(&trade.ada).await, ["opened"]);
    // Nor is an order written whose offer is wrong.
    trade
        .post(&trade.ada, "/cancel", &json!({ "text": "no" }))
        .await
        .good();
    let mut new = trade.new_order();
    new["offer"] = json!({ "firms": [strange] });
    let refused = trade.ada.post("/work-orders", &new).await;
    assert_eq!(refused.problem(), "invalid");
    let orders = trade.ada.get("/work-orders").await.good();
    assert_eq!(orders["items"].as_array().unwrap().len(), 1);
    new["offer"] = json!({ "firms": [rosas] });
    let request = || trade.ada.request(Method::POST, "/work-orders").json(&new);
    let made = Answer::of(request().header("Idempotency-Key", "1"))
        .await
        .good();
    assert_eq!(made["state"], "offered");
    let again = Answer::of(request().header("Idempotency-Key", "1"))
        .await
        .good();
    assert_eq!(made["id"], again["id"]);
    shore.finish().await;
}
