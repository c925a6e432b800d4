//! Sealed secrets: what the database has of them, and the change of the key.

use crate::second_factor::{app_code, now_s, set_up};
use binnacle_platform::db::{Db, Pools};
use binnacle_platform::{seal_rotation, signing_keys};
use binnacle_server_testing::{ApiResponse, PASSWORD, Person, TestServer, on_both};
use serde_json::json;

on_both!(
    sealed_secrets_are_used_but_are_not_in_the_database,
    a_new_key_seals_all_secrets_and_the_old_one_is_no_longer_needed,
    a_server_without_the_key_does_not_start,
);

fn key(letter: &str) -> String {
    letter.repeat(64)
}

/// A user with a second factor and a webhook, whose secrets were seen.
struct Owner {
    ada: Person,
    factor: String,
    webhook: String,
}

impl Owner {
    async fn new(server: &TestServer) -> Owner {
        let ada = server.admin("ada").await;
        let (factor, _) = set_up(server, &ada).await;
        let hook = json!({ "url": "https://example.com/hook", "kinds": ["alert.raised"] });
        let hook = ada.post("/webhooks", &hook).await.good();
        signing_keys::of_server(&server.app.db, server.app.clock.now().into())
            .await
            .unwrap();
        let webhook = hook["secret"].as_str().unwrap().to_owned();
        Owner {
            ada,
            factor,
            webhook,
        }
    }

    /// Signs in by a code of the authenticator app, and has the server sign.
    async fn use_secrets(&self, server: &TestServer) -> ApiResponse {
        server.advance(60.0);
        let now = server.app.clock.now().into();
        let signed = signing_keys::of_server(&server.app.db, now).await;
        signed
            .unwrap()
            .sign(b"text")
            .check(b"text", "text")
            .unwrap();
        let code = app_code(&self.factor, now_s(server));
        let body = json!({ "email": self.ada.email, "password": PASSWORD, "code": code });
        let request = server.http.post(format!("{}/api/v1/session", server.url));
        ApiResponse::send(request.json(&body)).await
    }
}

/// Secrets as they are stored, each with the key that sealed it.
type Stored<T> = Vec<(T, Option<String>)>;

/// Returns what the database stores of each secret.
async fn stored(db: &Db) -> Stored<String> {
    let sql = "SELECT secret, sealed_by FROM webhooks ORDER BY id";
    let bytes = "SELECT secret, sealed_by FROM second_factors
                 UNION ALL SELECT secret, sealed_by FROM signing_keys";
    let (mut texts, bytes): (Stored<String>, Stored<Vec<u8>>) = match db.pools() {
        Pools::Sqlite { readers, .. } => (
            sqlx::query_as(sql).fetch_all(readers).await.unwrap(),
            sqlx::query_as(bytes).fetch_all(readers).await.unwrap(),
        ),
        Pools::Postgres(pool) => (
            sqlx::query_as(sql).fetch_all(pool).await.unwrap(),
            sqlx::query_as(bytes).fetch_all(pool).await.unwrap(),
        ),
    };
    let hex = |bytes: Vec<u8>| binnacle_platform::ed25519::to_hex(&bytes);
    texts.extend(bytes.into_iter().map(|(bytes, by)| (hex(bytes), by)));
    texts
}

async fn sealed_secrets_are_used_but_are_not_in_the_database(server: TestServer) {
    let server = server.restart_with(&["--secrets-key", &key("a")]).await;
    let owner = Owner::new(&server).await;
    assert_eq!(owner.use_secrets(&server).await.status, 200);
    let secrets = stored(&server.app.db).await;
    assert_eq!(secrets.len(), 3);
    let current = server.app.db.seals().current().map(str::to_owned);
    for (secret, sealed_by) in &secrets {
        assert_eq!(*sealed_by, current);
        assert!(!secret.contains(&owner.webhook), "{secret}");
    }
    server.finish().await;
}

async fn a_new_key_seals_all_secrets_and_the_old_one_is_no_longer_needed(server: TestServer) {
    let owner = Owner::new(&server).await;
    assert!(
        stored(&server.app.db)
            .await
            .iter()
            .all(|(_, by)| by.is_none())
    );
    let both = format!("{},{}", key("b"), key("a"));
    let mut server = server;
    for keys in [key("a"), both] {
        server = server.restart_with(&["--secrets-key", &keys]).await;
        // What another key sealed, or none, is good until all are sealed again.
        assert_eq!(owner.use_secrets(&server).await.status, 200);
        let mut tx = server.app.db.begin().await.unwrap();
        assert_eq!(seal_rotation::seal_all(&mut tx).await.unwrap(), 3);
        assert_eq!(seal_rotation::seal_all(&mut tx).await.unwrap(), 0);
        tx.commit().await.unwrap();
    }
    let server = server.restart_with(&["--secrets-key", &key("b")]).await;
    seal_rotation::check(&server.app.db).await.unwrap();
    assert_eq!(owner.use_secrets(&server).await.status, 200);
    server.finish().await;
}

async fn a_server_without_the_key_does_not_start(server: TestServer) {
    let server = server.restart_with(&["--secrets-key", &key("a")]).await;
    let owner = Owner::new(&server).await;
    let sealed_by = server.app.db.seals().current().unwrap().to_owned();
    for settings in [vec![], vec!["--secrets-key".to_owned(), key("b")]] {
        let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
        let other = server.open_again(&settings).await;
        let refused = seal_rotation::check(&other).await.unwrap_err().to_string();
        assert!(refused.contains(&sealed_by), "{refused}");
        assert!(refused.contains("BINNACLE_SECRETS_KEY"), "{refused}");
        other.close().await;
    }
    assert_eq!(owner.use_secrets(&server).await.status, 200);
    server.finish().await;
}
