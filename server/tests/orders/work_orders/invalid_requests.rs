//! Repeated, impossible and forbidden requests at the berth.

use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::PICTURE;
use binnacle_server_testing::work_orders::{HEADING_DEG, Job, completion_details, reading};
use binnacle_server_testing::{ApiResponse, Person, TestServer};
use reqwest::Method;
use serde_json::{Value, json};

on_both!(
    a_request_repeated_under_its_key_writes_one_entry,
    a_request_delayed_for_days_is_written_once,
    a_bad_reading_is_logged_and_refused_with_likely_causes,
    a_reading_is_checked_against_the_port_and_the_track,
    correctors_can_be_restored_and_the_berth_read_again,
    a_step_with_an_unexpected_reading_is_planned_again,
    a_request_invalid_in_a_state_is_refused_and_writes_nothing,
    a_compass_has_one_open_order,
    a_viewer_can_read_but_not_change_an_order,
    an_order_is_not_found_for_another_operator,
);

async fn a_request_repeated_under_its_key_writes_one_entry(server: TestServer) {
    let job = Job::begin(&server).await;
    let send = |rest: &str, body: Value, key: &str| {
        let request = job.person.request(Method::POST, &job.path(rest));
        ApiResponse::send(request.header("idempotency-key", key).json(&body))
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
        let seq = job.view_order().await["last_seq"].clone();
        let repeated = send(rest, body, &key).await;
        assert_eq!(
            (repeated.status, &repeated.text),
            (first.status, &first.text)
        );
        assert_eq!(job.view_order().await["last_seq"], seq, "{rest}");
    }
    // A repeated step is not the next step.
    let step = job.view_order().await["next_step"].clone();
    let path = format!("/steps/{}", step["number"]);
    let read = json!({ "after_deg": step["expected_compass_deg"] });
    let first = send(&path, read.clone(), "step").await.good();
    let repeated = send(&path, read, "step").await.good();
    assert_eq!(first["steps_done"], 1);
    assert_eq!(first, repeated);
    let other = send(&path, json!({ "after_deg": 1.0 }), "step").await;
    assert_eq!(other.problem(), "idempotency-key-reused");
    server.finish().await;
}

async fn a_request_delayed_for_days_is_written_once(server: TestServer) {
    let mut job = Job::begin(&server).await;
    let photo = PICTURE.to_vec();
    for days in [0.0, 3.0, 40.0] {
        server.advance(86_400.0 * days);
        // The session has expired.
        job.person = Person::sign_in(&server, job.person.operator, &job.person.email).await;
        let send = |rest: &str, key: &str| {
            let request = job.person.request(Method::POST, &job.path(rest));
            request.header("idempotency-key", key)
        };
        let remark = send("/remarks", "remark").json(&json!({ "text": "crane alongside" }));
        ApiResponse::send(remark).await.good();
        let picture = send("/photos", "photo").body(photo.clone());
        ApiResponse::send(picture).await.good();
        let other = send("/remarks", "remark").json(&json!({ "text": "no crane" }));
        assert_eq!(
            ApiResponse::send(other).await.problem(),
            "idempotency-key-reused"
        );
        // Other requests meanwhile have keys of their own.
        let another = send("/remarks", &format!("after {days}"));
        let another = another.json(&json!({ "text": "crane gone" }));
        ApiResponse::send(another).await.good();
    }
    let log = job.person.get(&job.path("/entries")).await.good();
    let lines = log["items"].as_array().unwrap().iter();
    let kinds: Vec<&Value> = lines.map(|line| &line["entry"]["kind"]).collect();
    assert_eq!(
        kinds,
        [
            "opened", "as_found", "remark", "photo", "remark", "remark", "remark"
        ]
    );
    server.finish().await;
}

async fn a_bad_reading_is_logged_and_refused_with_likely_causes(server: TestServer) {
    let job = Job::begin(&server).await;
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
    for (entries, (body, message)) in [
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
        let response = job.post("/berth-reading", &body).await;
        assert_eq!(
            (response.status, response.problem().as_str()),
            (422, "not-adjustable")
        );
        let refusal = response.json()["refusals"][0].clone();
        let could_be = refusal["could_be"].to_string();
        assert!(could_be.contains(message), "{message}: {refusal}");
        assert!(!could_be.contains("across the needle"), "{refusal}");
        assert!(!refusal["cures"].as_array().unwrap().is_empty());
        let order = job.view_order().await;
        assert_eq!(
            (&order["state"], &order["reading"]),
            (&json!("planned"), &Value::Null)
        );
        assert_eq!(order["last_seq"], 3 + entries, "it is kept");
    }
    for (body, named) in [
        (with(json!({ "unit": "furlong" })), "unit"),
        (with(json!({ "forward": "much" })), "forward"),
        (with(json!({ "lat": 91.0 })), "lat"),
        (with(json!({ "at": "2027-01-01T00:00:00Z" })), "at"),
        (with(json!({ "foreward": 1.0 })), "foreward"),
    ] {
        let response = job.post("/berth-reading", &body).await;
        assert_eq!(
            (response.status, response.problem().as_str()),
            (422, "invalid")
        );
        assert!(response.text.contains(named), "{named}: {response:?}");
    }
    assert_eq!(
        job.view_order().await["last_seq"],
        5,
        "what cannot be read is not kept"
    );
    server.finish().await;
}

async fn a_reading_is_checked_against_the_port_and_the_track(server: TestServer) {
    let job = Job::begin(&server).await;
    let with = |changes: Value| {
        let mut body = reading();
        body.as_object_mut()
            .unwrap()
            .extend(changes.as_object().unwrap().clone());
        body
    };
    // A reading a week old is of no use for a plan.
    let old = with(json!({ "at": "2026-11-14T06:30:00Z" }));
    let response = job.post("/berth-reading", &old).await;
    assert_eq!(response.problem(), "invalid");
    assert!(response.text.contains("hours old"), "{response:?}");
    // East for west, and a time at which the ship was at sea by its track.
    for (body, words) in [
        (with(json!({ "lon": 3.04 })), "nautical miles from Bilbao"),
        (
            with(json!({ "at": "2026-11-19T22:00:00Z" })),
            "from the vessel's track",
        ),
    ] {
        let response = job.post("/berth-reading", &body).await;
        assert_eq!(response.problem(), "not-adjustable", "{body}");
        let refusal = response.json()["refusals"][0].clone();
        assert!(refusal.to_string().contains(words), "{words}: {refusal}");
        assert_eq!(job.view_order().await["state"], "planned");
    }
    job.post("/berth-reading", &reading()).await.good();
    server.finish().await;
}

async fn correctors_can_be_restored_and_the_berth_read_again(server: TestServer) {
    let job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let order = job.post("/plan", &json!({})).await.good();
    let before = order["next_step"]["setting_before"].clone();
    let path = format!("/steps/{}", order["next_step"]["number"]);
    let after = json!({ "after_deg": order["next_step"]["expected_compass_deg"] });
    job.post(&path, &after).await.good();
    let refused = job.post("/berth-reading", &reading()).await;
    assert_eq!(refused.problem(), "wrong-state");
    assert!(
        refused.text.contains("put the correctors back"),
        "{refused:?}"
    );
    let stand = json!({ "setting": before });
    job.post("/corrector-settings", &stand).await.good();
    let order = job.post("/berth-reading", &reading()).await.good();
    assert_eq!(order["state"], "measured");
    server.finish().await;
}

async fn a_step_with_an_unexpected_reading_is_planned_again(server: TestServer) {
    let job = Job::begin(&server).await;
    job.post("/berth-reading", &reading()).await.good();
    let mut order = job.post("/plan", &json!({})).await.good();
    // The first step with magnets, which an intercardinal heading shows.
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
    server.finish().await;
}

async fn a_request_invalid_in_a_state_is_refused_and_writes_nothing(server: TestServer) {
    let job = Job::begin(&server).await;
    let refused = |response: ApiResponse| {
        assert_eq!(
            (response.status, response.problem().as_str()),
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
    refused(job.post("/complete", &completion_details()).await);
    refused(job.person.get(&job.path("/evidence.zip")).await);
    let key = json!({ "public_key": "00".repeat(32), "signature": "00".repeat(64) });
    refused(job.post("/signatures", &key).await);
    assert_eq!(job.view_order().await["last_seq"], 2);
    job.post("/berth-reading", &reading()).await.good();
    job.post("/plan", &json!({})).await.good();
    refused(job.post("/steps/99", &json!({ "after_deg": 1.0 })).await);
    refused(job.post("/complete", &completion_details()).await);
    let tray = json!([{ "hole": 99, "magnet": "200 mm", "count": 1, "red": "port" }]);
    let nowhere = json!({ "setting": { "athwartship": tray } });
    let response = job.post("/corrector-settings", &nowhere).await;
    assert_eq!(
        (response.status, response.problem().as_str()),
        (422, "invalid")
    );
    assert!(
        response.text.contains("athwartship[0].hole"),
        "{response:?}"
    );
    let none = job.post("/plan", &json!({ "plan": 99 })).await;
    assert_eq!(none.problem(), "invalid");
    assert_eq!(job.view_order().await["last_seq"], 4);
    let cancelled = job
        .post("/cancel", &json!({ "text": "she sails" }))
        .await
        .good();
    assert_eq!(cancelled["state"], "cancelled");
    refused(job.post("/berth-reading", &reading()).await);
    refused(job.post("/cancel", &json!({ "text": "again" })).await);
    server.finish().await;
}

async fn a_compass_has_one_open_order(server: TestServer) {
    let job = Job::begin(&server).await;
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
    server.finish().await;
}

async fn a_viewer_can_read_but_not_change_an_order(server: TestServer) {
    let job = Job::begin(&server).await;
    let bob = job.person.viewer(&server).await;
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
        ("/complete", completion_details()),
    ] {
        let response = bob.post(&job.path(rest), &body).await;
        assert_eq!(
            (response.status, response.problem().as_str()),
            (403, "forbidden"),
            "{rest}"
        );
    }
    let made = bob.post("/work-orders", &job.new_order()).await;
    assert_eq!(made.problem(), "forbidden");
    assert_eq!(job.view_order().await["last_seq"], 2);
    server.finish().await;
}

async fn an_order_is_not_found_for_another_operator(server: TestServer) {
    let job = Job::begin(&server).await;
    let eve = server.admin("eve").await;
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
        ("/complete", completion_details()),
        ("/signatures", key),
    ] {
        let response = eve.post(&job.path(rest), &body).await;
        assert_eq!(response.problem(), "not-found", "{rest}");
    }
    let made = eve.post("/work-orders", &job.new_order()).await;
    assert_eq!(made.problem(), "not-found");
    assert_eq!(eve.get("/work-orders").await.good()["items"], json!([]));
    server.finish().await;
}
