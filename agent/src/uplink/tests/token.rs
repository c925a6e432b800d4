//! Which of two tokens the shore knows.

use super::*;

#[tokio::test]
async fn an_agent_that_did_not_hear_whether_its_token_was_replaced_tries_both() {
    let unknown = || problem(StatusCode::UNAUTHORIZED, "unauthorized");
    let fake = Fake {
        answers: [unknown()].into(),
        ..Fake::default()
    };
    let mut rig = rig(0, fake).await;
    let up = rig.link.wait_for(|link| link.state == LinkState::Up);
    up.await.unwrap();
    rig.spool.keep_other_token("new").await.unwrap();
    seal(&rig.spool, 1).await;
    rig.sealed.notify_one();
    rig.link.mark_unchanged();
    rig.all_sent().await;
    assert_eq!(rig.seqs(STREAM), [1]);
    let identity = rig.spool.identity().await.unwrap().unwrap();
    assert_eq!(identity.token, "new");
    assert_eq!(identity.other_token.as_deref(), Some("t"));
    let shown = format!("{identity:?}");
    assert!(!shown.contains("new"), "{shown}");
}
