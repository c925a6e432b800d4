//! Notifications of due dates.

use super::subjects_of;
use crate::schedule::{due_vessel, put};
use binnacle_planning::notifications::notify_of_needs;
use binnacle_server_testing::on_both;
use binnacle_server_testing::{Person, TestServer};
use serde_json::json;

on_both!(
    each_stage_before_the_due_date_is_notified_once,
    an_earlier_due_date_is_notified,
    two_servers_notify_a_due_date_once,
    an_unreadable_fleet_does_not_block_other_fleets_notifications,
);

const DAY_S: f64 = 86_400.0;

async fn each_stage_before_the_due_date_is_notified_once(server: TestServer) {
    let ada = server.admin("ada").await;
    let eve = server.admin("eve").await;
    due_vessel(&ada, "Nao").await;
    assert_eq!(notify_of_needs(&server.app).await.unwrap(), 1);
    assert_eq!(notify_of_needs(&server.app).await.unwrap(), 0);
    let soon = "Nao: Standard compass due for adjustment soon, by 2026-12-20";
    assert_eq!(subjects_of(&ada).await, [soon]);
    assert_eq!(subjects_of(&eve).await, [""; 0]);
    assert!(server.events().await.contains(&"need".to_owned()));
    for (days, steps) in [(14.0, 0), (2.0, 1), (1.0, 0), (12.0, 0), (1.0, 1), (9.0, 0)] {
        server.advance(days * DAY_S);
        assert_eq!(notify_of_needs(&server.app).await.unwrap(), steps, "{days}");
    }
    let ada = Person::sign_in(&server, ada.operator, &ada.email).await;
    let all = subjects_of(&ada).await;
    let overdue = "Nao: Standard compass overdue for adjustment, by 2026-12-20";
    assert_eq!(all, [soon, soon, overdue]);
    server.finish().await;
}

async fn an_earlier_due_date_is_notified(server: TestServer) {
    let ada = server.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let path = format!("/vessels/{}", nao["id"].as_str().unwrap());
    let adjusted = json!({ "kind": "adjustment", "from": "2026-11-01T08:00:00Z" });
    ada.post(&format!("{path}/logbook"), &adjusted).await.good();
    assert_eq!(notify_of_needs(&server.app).await.unwrap(), 0);
    let transits = json!({
        "flag_state": "NO", "transits": [{ "canal": "panama", "on": "2028-06-01" }]
    });
    let particulars = format!("{path}/particulars");
    put(&ada, &particulars, &transits).await.good();
    let docked = json!({ "kind": "dry_docking", "from": "2026-11-10T00:00:00Z" });
    ada.post(&format!("{path}/logbook"), &docked).await.good();
    assert_eq!(notify_of_needs(&server.app).await.unwrap(), 1);
    let listed = ada.get("/notifications").await.good();
    let raised = &listed["items"][0];
    assert_eq!(raised["kind"], "need_raised");
    let subject = "Nao: Standard compass due for adjustment sooner, by 2026-12-10";
    assert_eq!(raised["subject"], subject);
    assert!(
        raised["text"].as_str().unwrap().contains("dry-docking"),
        "{raised}"
    );
    // A new adjustment postpones it, which is not notified.
    let adjusted = json!({ "kind": "adjustment", "from": "2026-11-20T08:00:00Z" });
    ada.post(&format!("{path}/logbook"), &adjusted).await.good();
    assert_eq!(notify_of_needs(&server.app).await.unwrap(), 0);
    server.finish().await;
}

async fn two_servers_notify_a_due_date_once(server: TestServer) {
    let ada = server.admin("ada").await;
    due_vessel(&ada, "Nao").await;
    let other = server.second_server().await;
    let (one, two) = tokio::join!(notify_of_needs(&server.app), notify_of_needs(&other));
    assert_eq!(one.unwrap() + two.unwrap(), 1);
    assert_eq!(subjects_of(&ada).await.len(), 1);
    other.db.close().await;
    server.finish().await;
}

async fn an_unreadable_fleet_does_not_block_other_fleets_notifications(server: TestServer) {
    let ada = server.admin("ada").await;
    due_vessel(&ada, "Nao").await;
    server
        .run_sql("UPDATE vessel_particulars SET particulars = '{'")
        .await;
    // Created after Ada, and checked after her.
    let eve = server.admin("eve").await;
    due_vessel(&eve, "Pinta").await;
    assert_eq!(notify_of_needs(&server.app).await.unwrap(), 1);
    let soon = "Pinta: Standard compass due for adjustment soon, by 2026-12-20";
    assert_eq!(subjects_of(&eve).await, [soon]);
    server.finish().await;
}
