//! Things that a program has made with an API token and that outlive the token: receivers of
//! messages and calendars. Whoever revokes a leaked token needs to see them, and can remove them.

use crate::db::{self, Db, DomainEvent, Question, Tx, execute, rows};
use crate::error::Result;
use crate::ids::{TokenId, UserId};
use serde::Serialize;
use utoipa::ToSchema;
use uuid::Uuid;

/// Kind of what a token made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum MadeKind {
    /// Webhook; its name is the URL.
    Webhook,
    /// Recipient of mail about alerts; the name is the address.
    MailRecipient,
    /// Recipient of the monthly report; the name is the address.
    ReportRecipient,
    /// Calendar feed.
    CalendarFeed,
}

/// Thing that a token made and that goes on without it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = MadeByToken)]
pub struct Made {
    /// Kind of it.
    pub kind: MadeKind,
    /// Id of it.
    pub id: Uuid,
    /// Name or address of it.
    pub name: String,
}

/// Question for what a user's tokens have made in other capabilities, by token.
#[derive(Clone, Copy, Debug)]
pub struct MadeByTokens(pub UserId);

impl Question for MadeByTokens {
    type Answer = Vec<(TokenId, Made)>;
}

/// Revocation of a token with all that it made.
#[derive(Clone, Copy, Debug)]
pub struct RevokedWithMade {
    /// The token.
    pub token: TokenId,
}

impl DomainEvent for RevokedWithMade {}

/// Returns what a user's tokens have made, by token.
pub(crate) async fn list_made(db: &Db, user: UserId) -> db::Result<Vec<(TokenId, Made)>> {
    let mut tx = db.begin_reading().await?;
    let webhooks = rows!(
        in &mut tx,
        (TokenId, Uuid, String),
        "SELECT r.made_by_token, w.id, w.url FROM webhooks w
         JOIN receivers r ON r.id = w.id
         JOIN api_tokens t ON t.id = r.made_by_token
         WHERE t.user_id = $1
         ORDER BY w.id",
        user
    )?;
    let recipients = rows!(
        in &mut tx,
        (TokenId, Uuid, String),
        "SELECT r.made_by_token, m.id, m.address FROM mail_recipients m
         JOIN receivers r ON r.id = m.id
         JOIN api_tokens t ON t.id = r.made_by_token
         WHERE t.user_id = $1
         ORDER BY m.id",
        user
    )?;
    let mut made = named(MadeKind::Webhook, webhooks);
    made.extend(named(MadeKind::MailRecipient, recipients));
    made.extend(tx.ask(&MadeByTokens(user)).await?);
    Ok(made)
}

/// Returns rows of a token, an id and a name as what the token made.
pub fn named(kind: MadeKind, rows: Vec<(TokenId, Uuid, String)>) -> Vec<(TokenId, Made)> {
    let made = |(token, id, name)| (token, Made { kind, id, name });
    rows.into_iter().map(made).collect()
}

/// Removes what a token made.
pub(super) async fn remove_made(tx: &mut Tx, token: TokenId) -> Result<()> {
    // Each receiver goes with its channel's row and its deliveries.
    execute!(
        &mut *tx,
        "DELETE FROM receivers WHERE made_by_token = $1",
        token
    )?;
    tx.publish(&RevokedWithMade { token }).await
}
