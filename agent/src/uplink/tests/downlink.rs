//! Decisions of the server: cards, models, settings.

use super::*;

#[tokio::test]
async fn a_card_is_withdrawn_at_once_and_given_back() {
    let withdrawn = CardWithdrawn {
        since: time(),
        reason: "adjustment".to_owned(),
    };
    let fake = Fake {
        withdrawn: Some(withdrawn.clone()),
        ..Fake::default()
    };
    let mut rig = rig(1, fake).await;
    rig.all_sent().await;
    assert_eq!(*rig.withdrawn.borrow_and_update(), Some(withdrawn));
    rig.fake.lock().unwrap().withdrawn = None;
    seal(&rig.spool, 1).await;
    rig.sealed.notify_one();
    rig.withdrawn.wait_for(Option::is_none).await.unwrap();
    assert_eq!(rig.spool.card_withdrawn().await.unwrap(), None);
}

#[tokio::test]
async fn settings_are_in_effect_and_kept_and_then_asked_for_by_version() {
    let settings = other_settings();
    let mut rig = rig(2, Fake::with_settings(&settings)).await;
    rig.all_sent().await;
    assert_eq!(*rig.settings.borrow(), settings);
    assert_eq!(rig.spool.settings().await.unwrap(), settings);
    let fake = rig.fake.lock().unwrap();
    let asked: Vec<Option<&str>> = fake
        .queries
        .iter()
        .map(|q| q.get("settings").map(String::as_str))
        .collect();
    assert_eq!(asked, [None, Some("3")]);
}

#[tokio::test]
async fn an_agent_enrolled_for_another_compass_drops_the_decisions_for_the_first() {
    let settings = other_settings();
    let mut rig = rig(1, Fake::with_settings(&settings)).await;
    rig.all_sent().await;
    assert_eq!(*rig.settings.borrow_and_update(), settings);
    rig.fake.lock().unwrap().settings = None;
    let first = rig.spool.identity().await.unwrap().unwrap();
    let second = Identity {
        token: "another".to_owned(),
        compass_name: "Steering compass".to_owned(),
        ..first
    };
    rig.spool.enrol(&second).await.unwrap();
    rig.sealed.notify_one();
    let in_effect = rig.settings.wait_for(|settings| settings.version == 0);
    let in_time = timeout(Duration::from_secs(20), in_effect).await;
    assert!(in_time.is_ok(), "the old settings are still in effect");
}

#[tokio::test]
async fn a_model_that_cannot_be_read_leaves_the_one_on_board_unless_the_ship_was_altered() {
    let altered = CardWithdrawn {
        since: time(),
        reason: "lightning_or_shock".to_owned(),
    };
    for (replaces, withdrawn) in [(None, None), (Some(altered.clone()), Some(altered))] {
        let fake = Fake {
            unreadable: Some(json!({ "version": 9, "replaces": replaces, "model": "?" })),
            ..Fake::default()
        };
        let mut rig = rig(1, fake).await;
        rig.all_sent().await;
        assert_eq!(rig.spool.card_withdrawn().await.unwrap(), withdrawn);
        assert_eq!(*rig.withdrawn.borrow(), withdrawn);
    }
}
