//! What is sent twice, cannot be, or is not the caller's to do.

use super::{HEADING_DEG, Job, reading, word};
use crate::on_both;
use crate::support::{Answer, Person, Shore};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_request_sent_again_under_its_key_writes_one_entry,
    what_a_phone_kept_for_days_is_written_once,
    a_bad_reading_is_kept_and_refused_with_what_could_be_wrong,
    a_reading_is_doubted_by_the_port_and_by_the_track,
    what_was_moved_can_be_put_back_and_the_berth_read_again,
    a_step_that_reads_otherwise_is_planned_anew,
    what_cannot_be_done_in_a_state_is_refused_and_writes_nothing,
    a_compass_has_one_order_under_way,
    a_viewer_reads_an_order_and_does_not_write,
    an_order_is_blank_to_another_operator,
);

async fn a_request_sent_again_under_its_key_writes_one_entry(shore: Shore) {
    let job = Job::begin(&shore).await;
    let send = |rest: &str, body: Value, key: &str| {
        let request = job.person.request(Method::POST, &job.path(rest));
        Answer::of(request.header("idempotency-key", key).json(&body))
    };
    let mut bad = reading();
    bad["unit"] = json!("nanotesla");
    let steps: [(&str, Value, u16); 4] = [
        ("/remarks", json!({ "text": "crane alongside" }), 200),
        ("/berth-reading", bad, 422),
        ("/berth-reading", reading(), 200),
        ("/plan", json!({ "plan": 1 }), 200),
    ];
    for (index, (rest, body, status)) in steps.into_iter().enumerate() {
        let key = format!("key {index}");
        let first = send(rest, body.clone(), &key).await;
        assert_eq!(first.status, status, "{first:?}");
        let seq = job.seen().await["last_seq"].clone();
        let again = send(rest, body, &key).await;
        assert_eq!((again.status, &again.text), (first.status, &first.text));
        assert_eq!(job.seen().await["last_seq"], seq, "{rest}");
    }
    // A step that was sent again is not the next one.
    let step = job.seen().await["next_step"].clone();
    let path = format!("/steps/{}", step["number"]);
    let read = json!({ "after_deg": step["expected_compass_deg"] });
    let first = send(&path, read.clone(), "step").await.good();
    let again = send(&path, read, "step").await.good();
    assert_eq!(first["steps_done"], 1);
    assert_eq!(first, again);
    let other = send(&path, json!({ "after_deg": 1.0 }), "step").await;
    assert_eq!(other.problem(), "idempotency-key-reused");
    shore.finish().await;
}

async fn what_a_phone_kept_for_days_is_written_once(shore: Shore) {
    let mut job = Job::begin(&shore).await;
    let photo = super::PICTURE.to_vec();
    for days in [0.0, 3.0, 40.0] {
        shore.advance(86_400.0 * days);
        // No session lasts so long.
        job.person = Person::sign_in(&shore, job.person.operator, &job.person.email).await;
        let send = |rest: &str, key: &str| {
            let request = job.person.request(Method::POST, &job.path(rest));
            request.header("idempotency-key", key)
        };
        let remark = send("/remarks", "remark").json(&json!({ "text": "crane alongside" }));
        Answer::of(remark).await.good();
        let picture = send("/photos", "photo").body(photo.clone());
        Answer::of(picture).await.good();
        let other = send("/remarks", "remark").json(&json!({ "text": "no crane" }));
        assert_eq!(Answer::of(other).await.problem(), "idempotency-key-reused");
        // Whatever else is written meanwhile under keys of their own.
        let another = send("/remarks", &format!("after {days}"));
        let another = another.json(&json!({ "text": "crane gone" }));
        Answer::of(another).await.good();
    }
    let log = job.person.get(&job.path("/entries")).await.good();
    let lines = log["items"].as_array().unwrap().iter();
    let kinds: Vec<&Value> = lines.map(|line| &line["entry"]["kind"]).collect();
    assert_eq!(
        kinds,
        ["opened", "remark", "photo", "remark", "remark", "remark"]
    );
    shore.finish().await;
}

async fn a_bad_reading_is_kept_and_refused_with_what_could_be_wrong(shore: Shore) {
    let job = Job::begin(&shore).await;
    let good = reading();
    let part = |name: &str| good[name].as_f64().unwrap();
    let with = |changes: Value| {
        let mut body = good.clone();
        for (name, value) in changes.as_object().unwrap() {
            body[name] = value.clone();
        }
        body
    };
    let (forward, starboard) = (part("forward"), part("starboard"));
    for (entries, (body, said)) in [
        (
            with(json!({ "forward": forward / 100.0, "starboard": starboard / 100.0 })),
            "the figures are in gauss",
        ),
        (
            with(json!({ "forward": starboard, "starboard": forward })),
            "axes are swapped",
        ),
        (
            with(json!({ "heading_true_deg": HEADING_DEG + 180.0 })),
            "180 degrees off",
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let answer = job.post("/berth-reading", &body).await;
        assert_eq!(
            (answer.status, answer.problem().as_str()),
            (422, "not-adjustable")
        );
        let refusal = answer.json()["refusals"][0].clone();
        let could_be = refusal["could_be"].to_string();
        assert!(could_be.contains(said), "{said}: {refusal}");
        assert!(!could_be.contains("across the needle"), "{refusal}");
        assert!(!refusal["cures"].as_array().unwrap().is_empty());
        let order = job.seen().await;
        assert_eq!(
            (&order["state"], &order["reading"]),
            (&json!("planned"), &Value::Null)
        );
        assert_eq!(order["last_seq"], 2 + entries, "it is kept");
    }
    for (body, named) in [
        (with(json!({ "unit": "furlong" })), "unit"),
        (with(json!({ "forward": "much" })), "forward"),
        (with(json!({ "lat": 91.0 })), "lat"),
        (with(json!({ "at": "2027-01-01T00:00:00Z" })), "at"),
        (with(json!({ "foreward": 1.0 })), "foreward"),
    ] {
        let answer = job.post("/berth-reading", &body).await;
        assert_eq!((answer.status, answer.problem().as_str()), (422, "invalid"));
        assert!(answer.text.contains(named), "{named}: {answer:?}");
    }
    assert_eq!(
        job.seen().await["last_seq"],
        4,
        "what cannot be read is not kept"
    );
    shore.finish().await;
}

async fn a_reading_is_doubted_by_the_port_and_by_the_track(shore: Shore) {
    let job = Job::begin(&shore).await;
    let with = |changes: Value| {
        let mut body = reading();
        body.as_object_mut()
            .unwrap()
            .extend(changes.as_object().unwrap().clone());
        body
    };
    // Of a week ago no plan could be made.
    let old = with(json!({ "at": "2026-11-14T06:30:00Z" }));
    let answer = job.post("/berth-reading", &old).await;
    assert_eq!(answer.problem(), "invalid");
    assert!(answer.text.contains("hours old"), "{answer:?}");
    // East for west; and when by her own track she was at sea.
    for (body, words) in [
        (with(json!({ "lon": 3.04 })), "nautical miles from Bilbao"),
        (
            with(json!({ "at": "2026-11-19T22:00:00Z" })),
            "from the vessel's track",
        ),
    ] {
        let answer = job.post("/berth-reading", &body).await;
        assert_eq!(answer.problem(), "not-adjustable", "{body}");
        let refusal = answer.json()["refusals"][0].clone();
        assert!(refusal.to_string().contains(words), "{words}: {refusal}");
        assert_eq!(job.seen().await["state"], "planned");
    }
    job.post("/berth-reading", &reading()).await.good();
    shore.finish().await;
}

async fn what_was_moved_can_be_put_back_and_the_berth_read_again(shore: Shore) {
    let job = Job::begin(&shore).await;
    job.post("/berth-reading", &reading()).await.good();
    let order = job.post("/plan", &json!({})).await.good();
    let before = order["next_step"]["setting_before"].clone();
    let path = format!("/steps/{}", order["next_step"]["number"]);
    let after = json!({ "after_deg": order["next_step"]["expected_compass_deg"] });
    job.post(&path, &after).await.good();
    let refused = job.post("/berth-reading", &reading()).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert!(refused.text.contains("put the correctors back"), "{refused:?}");
    let stand = json!({ "setting": before });
    job.post("/corrector-settings", &stand).await.good();
    let order = job.post("/berth-reading", &reading()).await.good();
    assert_eq!(order["state"], "measured");
    shore.finish().await;
}

async fn a_step_that_reads_otherwise_is_planned_anew(shore: Shore) {
    let job = Job::begin(&shore).await;
    job.post("/berth-reading", &reading()).await.good();
    let mut order = job.post("/plan", &json!({})).await.good();
    // The first step with magnets in it, which a heading between the cardinals shows.
    while order["next_step"]["to"]["place"] != "magnets" {
        let step = &order["next_step"];
        let path = format!("/steps/{}", step["number"]);
        let after = json!({ "after_deg": step["expected_compass_deg"] });
        order = job.post(&path, &after).await.good();
    }
    let step = order["next_step"].clone();
    let before = order["compass_deg"].as_f64().unwrap();
    let change = step["change_deg"].as_f64().unwrap();
    let path = format!("/steps/{}", step["number"]);
    let wild = json!({ "after_deg": (before + 90.0).rem_euclid(360.0) });
    let unexplained = job.post(&path, &wild).await.good();
    assert_eq!(unexplained["last_step"]["verdict"], "unexplained");
    assert_eq!(
        unexplained["next_step"]["number"], step["number"],
        "it is to be read again"
    );
    let stronger = json!({ "after_deg": (before + 1.8 * change).rem_euclid(360.0) });
    let replanned = job.post(&path, &stronger).await.good();
    assert_eq!(
        replanned["last_step"]["verdict"], "other_strength",
        "{}",
        replanned["last_step"]
    );
    assert_eq!(replanned["steps_done"], 0);
    assert_eq!(
        replanned["setting"], step["setting_after"],
        "it stands as it was set"
    );
    shore.finish().await;
}

async fn what_cannot_be_done_in_a_state_is_refused_and_writes_nothing(shore: Shore) {
    let job = Job::begin(&shore).await;
    let refused = |answer: Answer| {
        assert_eq!(
            (answer.status, answer.problem().as_str()),
            (409, "wrong-state")
        );
    };
    refused(job.post("/plan", &json!({})).await);
    refused(job.person.get(&job.path("/plan")).await);
    refused(job.post("/steps/1", &json!({ "after_deg": 1.0 })).await);
    refused(
        job.post("/corrector-settings", &json!({ "setting": {} }))
            .await,
    );
    refused(job.post("/complete", &word()).await);
    refused(job.person.get(&job.path("/evidence.zip")).await);
    let key = json!({ "public_key": "00".repeat(32), "signature": "00".repeat(64) });
    refused(job.post("/signatures", &key).await);
    assert_eq!(job.seen().await["last_seq"], 1);
    job.post("/berth-reading", &reading()).await.good();
    job.post("/plan", &json!({})).await.good();
    refused(job.post("/steps/99", &json!({ "after_deg": 1.0 })).await);
    refused(job.post("/complete", &word()).await);
    let tray = json!([{ "hole": 99, "magnet": "200 mm", "count": 1, "red": "port" }]);
    let nowhere = json!({ "setting": { "athwartship": tray } });
    let answer = job.post("/corrector-settings", &nowhere).await;
    assert_eq!((answer.status, answer.problem().as_str()), (422, "invalid"));
    assert!(answer.text.contains("athwartship[0].hole"), "{answer:?}");
    let none = job.post("/plan", &json!({ "plan": 99 })).await;
    assert_eq!(none.problem(), "invalid");
    assert_eq!(job.seen().await["last_seq"], 3);
    let cancelled = job
        .post("/cancel", &json!({ "text": "she sails" }))
        .await
        .good();
    assert_eq!(cancelled["state"], "cancelled");
    refused(job.post("/berth-reading", &reading()).await);
    refused(job.post("/cancel", &json!({ "text": "again" })).await);
    shore.finish().await;
}

async fn a_compass_has_one_order_under_way(shore: Shore) {
    let job = Job::begin(&shore).await;
    let second = job.person.post("/work-orders", &job.new_order()).await;
    assert_eq!(
        (second.status, second.problem().as_str()),
        (409, "wrong-state")
    );
    job.post("/cancel", &json!({ "text": "another day" }))
        .await
        .good();
    let third = job
        .person
        .post("/work-orders", &job.new_order())
        .await
        .good();
    let list = job.person.get("/work-orders?limit=1").await.good();
    assert_eq!(list["items"][0]["id"], third["id"]);
    let next = list["next"].as_str().unwrap();
    let list = job
        .person
        .get(&format!("/work-orders?after={next}"))
        .await
        .good();
    assert_eq!(list["items"][0]["id"], job.order);
    let list = job.person.get("/work-orders?state=planned").await.good();
    assert_eq!(list["items"].as_array().unwrap().len(), 1);
    shore.finish().await;
}

async fn a_viewer_reads_an_order_and_does_not_write(shore: Shore) {
    let job = Job::begin(&shore).await;
    let bob = job.person.viewer(&shore).await;
    assert_eq!(bob.get(&job.path("")).await.good()["state"], "planned");
    assert_eq!(
        bob.get(&job.path("/entries")).await.good()["items"][0]["seq"],
        1
    );
    for (rest, body) in [
        ("/berth-reading", reading()),
        ("/plan", json!({})),
        ("/steps/1", json!({ "after_deg": 1.0 })),
        ("/corrector-settings", json!({ "setting": {} })),
        ("/remarks", json!({ "text": "hm" })),
        ("/cancel", json!({ "text": "hm" })),
        ("/close", json!({ "text": "hm" })),
        ("/complete", word()),
    ] {
        let answer = bob.post(&job.path(rest), &body).await;
        assert_eq!(
            (answer.status, answer.problem().as_str()),
            (403, "forbidden"),
            "{rest}"
        );
    }
    let made = bob.post("/work-orders", &job.new_order()).await;
    assert_eq!(made.problem(), "forbidden");
    assert_eq!(job.seen().await["last_seq"], 1);
    shore.finish().await;
}

async fn an_order_is_blank_to_another_operator(shore: Shore) {
    let job = Job::begin(&shore).await;
    let eve = shore.admin("eve").await;
    for rest in ["", "/entries", "/plan", "/evidence.zip", "/record.json"] {
        assert_eq!(
            eve.get(&job.path(rest)).await.problem(),
            "not-found",
            "{rest}"
        );
    }
    let key = json!({ "public_key": "00".repeat(32), "signature": "00".repeat(64) });
    for (rest, body) in [
        ("/berth-reading", reading()),
        ("/plan", json!({})),
        ("/steps/1", json!({ "after_deg": 1.0 })),
        ("/corrector-settings", json!({ "setting": {} })),
        ("/remarks", json!({ "text": "hm" })),
        ("/cancel", json!({ "text": "hm" })),
        ("/close", json!({ "text": "hm" })),
        ("/complete", word()),
        ("/signatures", key),
    ] {
        let answer = eve.post(&job.path(rest), &body).await;
        assert_eq!(answer.problem(), "not-found", "{rest}");
    }
    let made = eve.post("/work-orders", &job.new_order()).await;
    assert_eq!(made.problem(), "not-found");
    assert_eq!(eve.get("/work-orders").await.good()["items"], json!([]));
    shore.finish().await;
}
