//! Reports: due dates, deviations, jobs done and their savings.

use crate::schedule::{due_vessel, put};
use binnacle_planning::reports::make_due_reports;
use binnacle_server_testing::alerts::ship_with_model;
use binnacle_server_testing::mail::deliver;
use binnacle_server_testing::on_both;
use binnacle_server_testing::work_orders::Job;
use binnacle_server_testing::{Person, Relay, TestServer};
use serde_json::{Value, json};
use std::process::Command;

on_both!(
    a_report_lists_due_dates_and_deviations,
    a_job_is_compared_with_a_swing,
    the_report_files_agree_with_the_report,
    a_monthly_report_goes_once_to_its_recipients,
    a_failing_report_does_not_block_other_operators,
    a_job_received_after_its_month_is_in_the_next_report,
    invalid_settings_and_times_are_refused,
    a_report_contains_no_other_operators_fleet,
);

const DAY_S: f64 = 86_400.0;

async fn report(person: &Person, query: &str) -> Value {
    person.get(&format!("/reports/fleet{query}")).await.good()
}

async fn a_report_lists_due_dates_and_deviations(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = ship_with_model(&server, &ada).await;
    let santa = due_vessel(&ada, "Santa").await;
    let order = json!({
        "vessel_id": santa["id"], "compass_id": santa["compasses"][0]["id"], "port": "Bilbao",
        "planned_at": "2026-12-01T08:00:00Z",
    });
    ada.post("/work-orders", &order).await.good();
    let found = report(&ada, "").await;
    assert_eq!(found["operator_name"], "ada");
    assert_eq!(
        (&found["from"], &found["to"]),
        (&json!("2026-11-01"), &json!("2026-11-21"))
    );
    assert_eq!(
        (&found["vessels"], &found["compasses"]),
        (&json!(2), &json!(2))
    );
    let due = found["due"].as_array().unwrap();
    assert_eq!(
        (&due[0]["due_on"], &due[0]["urgency"]),
        (&json!("2026-12-20"), &json!("soon"))
    );
    assert_eq!(due[0]["order"]["port"], "Bilbao");
    assert_eq!(due[1]["vessel_name"], "Nao");
    assert_eq!(
        (&due[1]["urgency"], &due[1]["order"]),
        (&json!("unknown"), &json!(null))
    );
    let [first, second] = &found["deviation"].as_array().unwrap()[..] else {
        panic!("{found}")
    };
    let fleet = ada.get("/fleet").await.good();
    let worst = &fleet["vessels"][0]["worst"];
    assert_eq!(first["vessel_id"], nao.id.as_str());
    assert_eq!(first["compass_deg"], worst["compass_deg"]);
    let (one, other) = (&first["deviation_deg"], &worst["deviation_deg"]);
    assert!((one.as_f64().unwrap() - other.as_f64().unwrap()).abs() < 1e-3);
    assert_eq!(second["deviation_deg"], json!(null));
    assert_eq!(found["jobs"], json!([]));
    assert_eq!(found["saved"]["saved_eur"], 0.0);
    server.finish().await;
}

async fn a_job_is_compared_with_a_swing(server: TestServer) {
    let job = Job::begin(&server).await;
    job.complete().await;
    let found = report(&job.person, "").await;
    let [done] = &found["jobs"].as_array().unwrap()[..] else {
        panic!("{found}")
    };
    assert_eq!(
        (&done["order_id"], &done["port"]),
        (&json!(job.order), &json!("Bilbao"))
    );
    assert_eq!(
        (&done["state"], &done["fee_eur"]),
        (&json!("adjusted"), &json!(null))
    );
    // The paper's figures, unless the operator sets others.
    let usual = json!({
        "jobs": 1, "swings": 1, "swing_eur": 6000.0, "swing_h": 3.0, "fees_eur": 0.0, "without_fee": 1,
        "saved_eur": 6000.0, "saved_h": 3.0,
    });
    assert_eq!(found["saved"], usual);
    let own = json!({ "swing_eur": 4500.5, "swing_h": 4.5 });
    put(&job.person, "/reports/settings", &own).await.good();
    let found = report(&job.person, "").await;
    assert_eq!(found["saved"]["saved_eur"], 4500.5);
    assert_eq!(found["saved"]["saved_h"], 4.5);
    let before = report(&job.person, "?from=2026-10-01&to=2026-11-20").await;
    assert_eq!(before["jobs"], json!([]));
    // An adjustment that is not confirmed at sea has not saved a swing.
    let failed = [
        "UPDATE work_orders SET state = 'failed'",
        "UPDATE work_orders SET state = 'closed'",
    ];
    for (stands, sql) in ["failed", "closed"].into_iter().zip(failed) {
        server.run_sql(sql).await;
        let failed = report(&job.person, "").await;
        assert_eq!(failed["jobs"][0]["state"], stands);
        assert_eq!(failed["jobs"][0]["spared_swing"], false);
        assert_eq!(failed["saved"]["saved_eur"], 0.0);
    }
    server.finish().await;
}

async fn the_report_files_agree_with_the_report(server: TestServer) {
    let ada = server.admin("ada").await;
    due_vessel(&ada, "=HYPERLINK(\"x\"), Nao").await;
    let due = ada.get("/reports/fleet.csv").await;
    assert_eq!(due.headers["content-type"], "text/csv; charset=utf-8");
    let name = due.headers["content-disposition"].to_str().unwrap();
    assert_eq!(
        name,
        "inline; filename=\"compass-due-ada-2026-11-01-2026-11-21.csv\"; \
         filename*=UTF-8''compass%20due%20ada%202026-11-01%202026-11-21.csv"
    );
    let lines: Vec<&str> = due.text.lines().collect();
    assert!(lines[0].starts_with("vessel_name,compass_name,due_on,urgency,reason,"));
    let line = "\"'=HYPERLINK(\"\"x\"\"), Nao\",Standard compass,2026-12-20,soon,";
    assert!(lines[1].starts_with(line), "{}", lines[1]);
    for (table, head) in [
        (
            "deviation",
            "vessel_name,compass_name,compass_deg,deviation_deg,band95_deg",
        ),
        (
            "jobs",
            "vessel_name,compass_name,port,completed_at,firm,state,fee_eur",
        ),
    ] {
        let csv = ada.get(&format!("/reports/fleet.csv?table={table}")).await;
        assert!(csv.text.starts_with(head), "{}", csv.text);
    }
    let odd = ada.get("/reports/fleet.csv?table=gossip").await;
    assert_eq!(odd.status, 400, "{odd:?}");
    let request = ada.request(reqwest::Method::GET, "/reports/fleet.pdf");
    let response = request.send().await.unwrap();
    assert_eq!(response.headers()["content-type"], "application/pdf");
    let pdf = response.bytes().await.unwrap();
    assert!(pdf.starts_with(b"%PDF-"));
    // The same report has the same bytes.
    let request = ada.request(reqwest::Method::GET, "/reports/fleet.pdf");
    assert_eq!(request.send().await.unwrap().bytes().await.unwrap(), pdf);
    server.finish().await;
}

/// Parses a letter's text and attachments with Python's mail parser.
fn parse_letter(letter: &str) -> Value {
    let program = "import email, email.policy, json, sys\n\
        m = email.message_from_bytes(sys.argv[1].encode(), policy=email.policy.default)\n\
        assert not m.defects, m.defects\n\
        files = {a.get_filename(): (a.get_content_type(), a.get_content()) for a in m.iter_attachments()}\n\
        seen = {n: [t, c[:5].decode() if isinstance(c, bytes) else c] for n, (t, c) in files.items()}\n\
        print(json.dumps({'text': m.get_body().get_content(), 'files': seen}))";
    let done = Command::new("python3")
        .args(["-c", program, letter])
        .output()
        .unwrap();
    assert!(
        done.status.success(),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    serde_json::from_slice(&done.stdout).unwrap()
}

async fn a_monthly_report_goes_once_to_its_recipients(server: TestServer) {
    let relay = Relay::start().await;
    let ada = server.admin("ada").await;
    due_vessel(&ada, "Nao").await;
    let new_settings =
        json!({ "monthly_to": ["Chief@Example.com", "chief@example.com", "b@example.com"] });
    let stored = put(&ada, "/reports/settings", &new_settings).await.good();
    let kept = json!(["Chief@example.com", "chief@example.com", "b@example.com"]);
    assert_eq!(stored["monthly_to"], kept);
    let fewer = json!({ "monthly_to": ["b@example.com"] });
    put(&ada, "/reports/settings", &fewer).await.good();
    // October ended before the list had a recipient.
    assert_eq!(make_due_reports(&server.app).await.unwrap(), 0);
    server.advance(9.95 * DAY_S);
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    let late = json!({ "monthly_to": ["b@example.com", "late@example.com"] });
    assert_eq!(make_due_reports(&server.app).await.unwrap(), 0);
    put(&ada, "/reports/settings", &late).await.good();
    server.advance(0.05 * DAY_S);
    let other = server.second_server().await;
    let (one, two) = tokio::join!(make_due_reports(&server.app), make_due_reports(&other));
    assert_eq!(one.unwrap() + two.unwrap(), 1);
    assert_eq!(make_due_reports(&server.app).await.unwrap(), 0);
    deliver(&server, &relay).await;
    let got = relay.letters();
    assert_eq!(got.len(), 1);
    assert_eq!(got[0].to, ["<b@example.com>"]);
    let letter = &got[0];
    assert!(letter.text.contains("Subject: Compass report of 2026-11"));
    let read = parse_letter(&letter.text);
    let text = read["text"].as_str().unwrap();
    assert!(
        text.contains("Fleet:              1 vessels, 1 compasses"),
        "{text}"
    );
    assert!(text.contains("for monthly"), "{text}");
    assert_eq!(
        read["files"]["compass-report-2026-11.pdf"],
        json!(["application/pdf", "%PDF-"])
    );
    let due = read["files"]["compass-due-2026-11.csv"][1]
        .as_str()
        .unwrap();
    assert!(due.contains("Nao,Standard compass,2026-12-20"), "{due}");
    assert_eq!(read["files"].as_object().unwrap().len(), 4);
    other.db.close().await;
    server.finish().await;
}

async fn a_failing_report_does_not_block_other_operators(server: TestServer) {
    let (ada, eve) = (server.admin("ada").await, server.admin("eve").await);
    due_vessel(&ada, "Nao").await;
    server
        .run_sql("UPDATE vessel_particulars SET particulars = '{'")
        .await;
    due_vessel(&eve, "Pinta").await;
    let new_settings = json!({ "monthly_to": ["chief@example.com"] });
    for admin in [&ada, &eve] {
        put(admin, "/reports/settings", &new_settings).await.good();
    }
    server.advance(10.0 * DAY_S);
    assert_eq!(make_due_reports(&server.app).await.unwrap(), 1);
    server.finish().await;
}

async fn a_job_received_after_its_month_is_in_the_next_report(server: TestServer) {
    let relay = Relay::start().await;
    let job = Job::begin(&server).await;
    let ada = &job.person;
    let new_settings = json!({ "monthly_to": ["b@example.com"] });
    put(ada, "/reports/settings", &new_settings).await.good();
    job.complete().await;
    assert_eq!(report(ada, "").await["jobs"][0]["order_id"], job.order);
    // As if the phone had kept it until the second of December, 00:00 UTC.
    server
        .run_sql(
            "UPDATE work_orders SET completion_received_at = 1796169600000000
             WHERE completion_received_at >= completed_at",
        )
        .await;
    let mut rows = Vec::new();
    // The first of December, of January and of February.
    for days in [10.0, 31.0, 31.0] {
        server.advance(days * DAY_S);
        assert_eq!(make_due_reports(&server.app).await.unwrap(), 1);
        deliver(&server, &relay).await;
        let letter = relay.letters().pop().unwrap();
        let files = parse_letter(&letter.text)["files"].clone();
        let jobs = files.as_object().unwrap().iter();
        let mut jobs = jobs.filter(|(name, _)| name.starts_with("compass-jobs"));
        let csv = jobs.next().unwrap().1[1].as_str().unwrap().to_owned();
        rows.push(csv.lines().count() - 1);
    }
    assert_eq!(rows, [0, 1, 0]);
    server.finish().await;
}

async fn invalid_settings_and_times_are_refused(server: TestServer) {
    let ada = server.admin("ada").await;
    let many: Vec<String> = (0..21).map(|n| format!("a{n}@example.com")).collect();
    for bad in [
        json!({ "swing_eur": -1 }),
        json!({ "swing_eur": 1e9 }),
        json!({ "swing_h": 100 }),
        json!({ "monthly_to": ["nobody"] }),
        json!({ "monthly_to": ["a@example.com\r\nBcc: b@example.com"] }),
        json!({ "monthly_to": many }),
        json!({ "colour": "red" }),
    ] {
        let refused = put(&ada, "/reports/settings", &bad).await;
        assert_eq!(refused.problem(), "invalid", "{bad}");
    }
    for bad in ["?from=2026-11-22&to=2026-11-21", "?from=1990-01-01"] {
        let refused = ada.get(&format!("/reports/fleet{bad}")).await;
        assert_eq!(refused.problem(), "invalid", "{bad}");
    }
    let odd = ada.get("/reports/fleet?from=yesterday").await;
    assert_eq!(odd.status, 400, "{odd:?}");
    let viewer = ada.viewer(&server).await;
    let refused = put(&viewer, "/reports/settings", &json!({})).await;
    assert_eq!(refused.problem(), "forbidden");
    report(&viewer, "").await;
    server.finish().await;
}

async fn a_report_contains_no_other_operators_fleet(server: TestServer) {
    let job = Job::begin(&server).await;
    job.complete().await;
    let eve = server.admin("eve").await;
    let found = report(&eve, "").await;
    for table in ["due", "deviation", "jobs"] {
        assert_eq!(found[table], json!([]), "{table}");
    }
    let (_, rosa) = job.person.adjuster(&server, "rosa").await;
    assert_eq!(rosa.get("/reports/fleet").await.problem(), "forbidden");
    server.finish().await;
}
