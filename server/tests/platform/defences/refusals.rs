//! Refused sign-ins, codes and tokens: seen in the audit log, in the server's own log, and by the
//! operator's admins.

use crate::second_factor::set_up;
use crate::secrets::Program;
use binnacle_platform::session::Role;
use binnacle_platform::sign_in_watch::notify_of_many;
use binnacle_server_testing::{
    ApiResponse, HOUR_S, PASSWORD, Person, TestServer, client, on_both, try_sign_in,
};
use serde_json::{Value, json};

on_both!(
    each_refused_sign_in_has_an_audit_line,
    a_caller_who_is_turned_away_has_one_audit_line_a_minute,
    what_has_not_the_form_of_an_address_is_not_kept,
    whatever_a_network_types_it_fills_no_audit_log,
    an_operators_admins_hear_once_of_many_refused_sign_ins,
);

const REFUSED: &str = "/audit?refused=true";

/// Returns the refusals in the audit log, in order: reason, account, status.
async fn refusals(person: &Person) -> Vec<String> {
    let listed = person.get(REFUSED).await.good();
    let mut lines: Vec<Value> = listed["items"].as_array().unwrap().clone();
    lines.reverse();
    let shown = |line: &Value| {
        assert_eq!(line["address"], "127.0.0.1");
        let account = line["account"].as_str().unwrap_or("-");
        let reason = line["refusal"].as_str().unwrap();
        format!("{reason} {account} {}", line["status"])
    };
    lines.iter().map(shown).collect()
}

async fn with_token(server: &TestServer, token: &str) -> ApiResponse {
    let request = server.http.get(format!("{}/api/v1/vessels", server.url));
    ApiResponse::send(request.bearer_auth(token)).await
}

async fn each_refused_sign_in_has_an_audit_line(server: TestServer) {
    let ada = server.admin("ada").await;
    let root = ada.platform_admin(&server).await;
    let eve = server.admin("eve").await;
    set_up(&server, &ada).await;
    let sign_in = async |email: &str, password: &str, code: &str| {
        let body = json!({ "email": email, "password": password, "code": code });
        let request = server.http.post(format!("{}/api/v1/session", server.url));
        ApiResponse::send(request.json(&body)).await.problem()
    };
    assert_eq!(sign_in(&ada.email, "a guess", "").await, "wrong-password");
    let nobody = "nobody@example.com";
    assert_eq!(sign_in(nobody, "a guess", "").await, "wrong-password");
    assert_eq!(sign_in(&ada.email, PASSWORD, "000000").await, "wrong-code");
    for _ in 0..3 {
        sign_in(&ada.email, "a guess", "").await;
    }
    assert_eq!(sign_in(&ada.email, PASSWORD, "").await, "throttled");
    assert_eq!(with_token(&server, "bna_invented").await.status, 401);
    let code = json!({ "code": "AAAA-BBBB-CCCC-DDDD", "password": "seven gulls over the quay" });
    let url = format!("{}/api/v1/invitations/accept", server.url);
    let unknown = ApiResponse::send(server.http.post(url).json(&code)).await;
    assert_eq!(unknown.problem(), "not-found");

    let of_ada = [
        "wrong_password ada@example.com 401",
        "wrong_code ada@example.com 401",
        "wrong_password ada@example.com 401",
        "wrong_password ada@example.com 401",
        "wrong_password ada@example.com 401",
        "throttled ada@example.com 429",
    ];
    assert_eq!(refusals(&ada).await, of_ada);
    let all = refusals(&root).await;
    assert_eq!(all.len(), of_ada.len() + 3, "{all:?}");
    for line in [
        "wrong_password nobody@example.com 401",
        "invalid_token - 401",
        "invalid_code - 404",
    ] {
        assert!(all.iter().any(|known| known == line), "{line}: {all:?}");
    }
    assert_eq!(refusals(&eve).await, [""; 0]);
    let listed = root.get(REFUSED).await;
    for secret in ["a guess", "000000", "bna_invented", "AAAA"] {
        assert!(!listed.text.contains(secret), "{secret}: {listed:?}");
    }
    let kinds = listed.good()["items"].clone();
    let kinds = kinds.as_array().unwrap().iter();
    let unidentified = kinds.filter(|line| line["actor_kind"] == "unidentified");
    // Who sent a wrong code had sent the right password.
    assert_eq!(unidentified.count(), all.len() - 1);
    server.finish().await;
}

async fn a_caller_who_is_turned_away_has_one_audit_line_a_minute(server: TestServer) {
    let ada = server.admin("ada").await;
    let root = ada.platform_admin(&server).await;
    for number in 0..5 {
        with_token(&server, &format!("bna_invented{number}")).await;
    }
    assert_eq!(refusals(&root).await, ["invalid_token - 401"]);
    server.advance(60.0);
    with_token(&server, "bna_invented").await;
    assert_eq!(refusals(&root).await, ["invalid_token - 401"; 2]);
    server.finish().await;
}

async fn what_has_not_the_form_of_an_address_is_not_kept(server: TestServer) {
    let ada = server.admin("ada").await;
    let root = ada.platform_admin(&server).await;
    for typed in [
        "seven gulls over the quay",
        "ada@example.com\nWARN",
        "x@y z",
    ] {
        let refused = try_sign_in(&server, typed, "a guess").await;
        assert_eq!(refused.problem(), "wrong-password");
    }
    assert_eq!(refusals(&root).await, ["wrong_password - 401"; 3]);
    server.finish().await;
}

async fn whatever_a_network_types_it_fills_no_audit_log(server: TestServer) {
    let ada = server.admin("ada").await;
    let root = ada.platform_admin(&server).await;
    let too_long = "x".repeat(1025);
    for number in 0..80 {
        let (email, password) = match number % 2 {
            0 => (format!("{number}\u{7}@example.com"), "a guess"),
            _ => (format!("{number}@example.com"), too_long.as_str()),
        };
        let refused = try_sign_in(&server, &email, password).await;
        let expected = if number < 50 {
            "wrong-password"
        } else {
            "throttled"
        };
        assert_eq!(refused.problem(), expected, "{number}");
    }
    // Those beyond have one line together.
    let listed = root.get("/audit?refused=true&limit=200").await.good();
    assert_eq!(listed["items"].as_array().unwrap().len(), 51);
    server.finish().await;
}

async fn an_operators_admins_hear_once_of_many_refused_sign_ins(server: TestServer) {
    let ada = server.admin("ada").await;
    let viewer = ada.viewer(&server).await;
    let eve = server.admin("eve").await;
    let fleet = Some(ada.operator.into());
    Person::create(&server, fleet, "bob@example.com", Role::Viewer).await;
    Person::create(&server, fleet, "col@example.com", Role::Viewer).await;
    let notices = async |who: &Person| {
        let listed = who.get("/notifications?kind=sign_ins_refused").await;
        listed.good()["items"].as_array().unwrap().clone()
    };
    for email in [&ada.email, "bob@example.com", "col@example.com"] {
        for _ in 0..5 {
            try_sign_in(&server, email, "a guess").await;
        }
    }
    assert_eq!(notify_of_many(&server.app).await.unwrap(), 0);
    for _ in 0..5 {
        try_sign_in(&server, &viewer.email, "a guess").await;
    }
    assert_eq!(notify_of_many(&server.app).await.unwrap(), 1);
    let heard = notices(&ada).await;
    assert_eq!(heard.len(), 1);
    assert_eq!(
        heard[0]["subject"],
        "20 sign-ins were refused within an hour"
    );
    let text = heard[0]["text"].as_str().unwrap();
    assert!(
        text.contains("bob@example.com from 127.0.0.1: 5 times"),
        "{text}"
    );
    assert!(notices(&eve).await.is_empty());
    let of_viewer = viewer.get("/notifications").await.good();
    assert_eq!(of_viewer["items"], json!([]));
    server.advance(HOUR_S / 2.0);
    assert_eq!(notify_of_many(&server.app).await.unwrap(), 0);
    server.finish().await;
}

#[tokio::test]
async fn a_refusal_is_logged_with_its_address_before_what_a_stranger_wrote() {
    let folder = tempfile::tempdir().unwrap();
    let program = Program::start(folder.path(), "info", &[]);
    let forged = "x@y\"address=198.51.100.7";
    for email in ["ada@example.com", forged] {
        let body = json!({ "email": email, "password": "a-wrong-guess" });
        let request = client().post(format!("{}/api/v1/session", program.url));
        assert_eq!(ApiResponse::send(request.json(&body)).await.status, 401);
    }
    let log = program.stop();
    let refused: Vec<&str> = log
        .lines()
        .filter(|line| line.contains("binnacle::refused: "))
        .collect();
    let expected = [
        r#"refusal="wrong_password" address=127.0.0.1 account="ada@example.com" route="#,
        r#"refusal="wrong_password" address=127.0.0.1 account="x@y\"address=198.51.100.7" route="#,
    ];
    assert_eq!(refused.len(), expected.len(), "{log}");
    for (line, expected) in refused.iter().zip(expected) {
        assert!(line.contains(expected), "{line}");
    }
    assert!(!log.contains("a-wrong-guess"), "{log}");
}
