//! Needs that press, and due dates that come nearer.

use super::told;
use crate::on_both;
use crate::planning::{due_vessel, put};
use crate::support::{Person, Shore};
use binnacle_planning::notifications::notify_of_needs;
use serde_json::json;

on_both!(
    each_step_towards_the_due_date_is_told_once,
    a_due_date_that_is_brought_forward_is_told,
    two_servers_tell_of_a_need_once,
    a_fleet_that_cannot_be_read_holds_up_no_other_fleets_needs,
);

const DAY_S: f64 = 86_400.0;

async fn each_step_towards_the_due_date_is_told_once(shore: Shore) {
    let ada = shore.admin("ada").await;
    let eve = shore.admin("eve").await;
    due_vessel(&ada, "Nao").await;
    assert_eq!(notify_of_needs(&shore.app).await.unwrap(), 1);
    assert_eq!(notify_of_needs(&shore.app).await.unwrap(), 0);
    let soon = "Nao: Standard compass due for adjustment soon, by 2026-12-20";
    assert_eq!(told(&ada).await, [soon]);
    assert_eq!(told(&eve).await, [""; 0]);
    assert!(shore.events().await.contains(&"need".to_owned()));
    for (days, steps) in [(14.0, 0), (2.0, 1), (1.0, 0), (12.0, 0), (1.0, 1), (9.0, 0)] {
        shore.advance(days * DAY_S);
        assert_eq!(notify_of_needs(&shore.app).await.unwrap(), steps, "{days}");
    }
    let ada = Person::sign_in(&shore, ada.operator, &ada.email).await;
    let all = told(&ada).await;
    let overdue = "Nao: Standard compass overdue for adjustment, by 2026-12-20";
    assert_eq!(all, [soon, soon, overdue]);
    shore.finish().await;
}

async fn a_due_date_that_is_brought_forward_is_told(shore: Shore) {
    let ada = shore.admin("ada").await;
    let nao = due_vessel(&ada, "Nao").await;
    let path = format!("/vessels/{}", nao["id"].as_str().unwrap());
    let adjusted = json!({ "kind": "adjustment", "from": "2026-11-01T08:00:00Z" });
    ada.post(&format!("{path}/logbook"), &adjusted).await.good();
    assert_eq!(notify_of_needs(&shore.app).await.unwrap(), 0);
    let transits = json!({
        "flag_state": "NO", "transits": [{ "canal": "panama", "on": "2028-06-01" }]
    });
    let particulars = format!("{path}/particulars");
    put(&ada, &particulars, &transits).await.good();
    let docked = json!({ "kind": "dry_docking", "from": "2026-11-10T00:00:00Z" });
    ada.post(&format!("{path}/logbook"), &docked).await.good();
    assert_eq!(notify_of_needs(&shore.app).await.unwrap(), 1);
    let listed = ada.get("/notifications").await.good();
    let raised = &listed["items"][0];
    assert_eq!(raised["kind"], "need_raised");
    let subject = "Nao: Standard compass due for adjustment sooner, by 2026-12-10";
    assert_eq!(raised["subject"], subject);
    assert!(
        raised["text"].as_str().unwrap().contains("dry-docking"),
        "{raised}"
    );
    // Adjusted again, it is put off: that is no news.
    let adjusted = json!({ "kind": "adjustment", "from": "2026-11-20T08:00:00Z" });
    ada.post(&format!("{path}/logbook"), &adjusted).await.good();
    assert_eq!(notify_of_needs(&shore.app).await.unwrap(), 0);
    shore.finish().await;
}

async fn two_servers_tell_of_a_need_once(shore: Shore) {
    let ada = shore.admin("ada").await;
    due_vessel(&ada, "Nao").await;
    let other = shore.second().await;
    let (one, two) = tokio::join!(notify_of_needs(&shore.app), notify_of_needs(&other));
    assert_eq!(one.unwrap() + two.unwrap(), 1);
    assert_eq!(told(&ada).await.len(), 1);
    other.db.close().await;
    shore.finish().await;
}

async fn a_fleet_that_cannot_be_read_holds_up_no_other_fleets_needs(shore: Shore) {
    let ada = shore.admin("ada").await;
    due_vessel(&ada, "Nao").await;
    shore
        .sql("UPDATE vessel_particulars SET particulars = '{'")
        .await;
    // Entered after her, and looked through after her.
    let eve = shore.admin("eve").await;
    due_vessel(&eve, "Pinta").await;
    assert_eq!(notify_of_needs(&shore.app).await.unwrap(), 1);
    let soon = "Pinta: Standard compass due for adjustment soon, by 2026-12-20";
    assert_eq!(told(&eve).await, [soon]);
    shore.finish().await;
}
