//! Forms of messages: the product's own, and those that chats show to people.
//!
//! Invariant: a message is queued in its own form alone. What a chat gets is made of its words when
//! it is sent.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use utoipa::ToSchema;

/// Form of a webhook's messages.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema, sqlx::Type,
)]
#[serde(rename_all = "snake_case")]
#[sqlx(type_name = "text", rename_all = "snake_case")]
#[schema(as = WebhookFormat)]
pub(super) enum Format {
    /// Message for a program, as documented.
    #[default]
    Binnacle,
    /// Message for an incoming webhook of Slack, Mattermost or Rocket.Chat: a member `text`.
    Slack,
    /// Adaptive card for a workflow of Microsoft Teams.
    Teams,
}

/// Message in words, for people.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[schema(as = MessageWords)]
pub struct Words {
    /// Subject of the message, in a line.
    #[schema(example = "Nao Victoria: warning, deviation over the limit")]
    pub headline: String,
    /// More of it.
    #[schema(example = "Deviation is 7.4° E on compass heading 095°, over the limit of 5°.")]
    pub text: String,
    /// Path of the dashboard's page about it.
    #[schema(example = "/alerts#019ab3f0-6c1d-7a80-8a3b-5a5f3c9d7e20")]
    pub path: String,
}

/// Part of a queued message that a chat shows.
#[derive(Deserialize)]
struct Queued {
    kind: String,
    words: Option<Words>,
}

impl Format {
    /// Returns the body to send, of a message as it is queued. `public_url` is the dashboard's
    /// address, if the server knows it.
    ///
    /// # Errors
    /// Fails when the message is not as it was queued.
    pub(super) fn body(
        self,
        queued: &str,
        public_url: Option<&str>,
    ) -> Result<String, serde_json::Error> {
        if self == Format::Binnacle {
            return Ok(queued.to_owned());
        }
        let Queued { kind, words } = serde_json::from_str(queued)?;
        // An older release has queued it without words.
        let words = words.unwrap_or(Words {
            headline: kind,
            text: String::new(),
            path: "/".to_owned(),
        });
        let page = public_url.map(|at| format!("{}{}", at.trim_end_matches('/'), words.path));
        let chat = match self {
            Format::Teams => card(&words, page.as_deref()),
            Format::Binnacle | Format::Slack => {
                json!({ "text": marked_up(&words, page.as_deref()) })
            }
        };
        Ok(chat.to_string())
    }
}

/// Returns the words in Slack's markup (Slack, "Formatting message text").
fn marked_up(words: &Words, page: Option<&str>) -> String {
    let escaped = |text: &str| {
        let text = text.replace('&', "&amp;");
        text.replace('<', "&lt;").replace('>', "&gt;")
    };
    let mut lines = vec![format!("*{}*", escaped(&words.headline))];
    lines.extend((!words.text.is_empty()).then(|| escaped(&words.text)));
    lines.extend(page.map(|page| format!("<{page}|Open in Binnacle>")));
    lines.join("\n")
}

/// Returns the words as an adaptive card, version 1.4 (Microsoft, "Adaptive Card Schema").
fn card(words: &Words, page: Option<&str>) -> Value {
    let block = |text: &str, weight: &str| json!({ "type": "TextBlock", "wrap": true, "weight": weight, "text": text });
    let mut body = vec![block(&words.headline, "Bolder")];
    body.extend((!words.text.is_empty()).then(|| block(&words.text, "Default")));
    let open = page
        .map(|page| json!({ "type": "Action.OpenUrl", "title": "Open in Binnacle", "url": page }));
    json!({
        "type": "message",
        "attachments": [{
            "contentType": "application/vnd.microsoft.card.adaptive",
            "content": {
                "$schema": "http://adaptivecards.io/schemas/adaptive-card.json",
                "type": "AdaptiveCard", "version": "1.4", "body": body,
                "actions": Vec::from_iter(open),
            },
        }],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn queued() -> String {
        let words = Words {
            headline: "Nao <1> & co: warning".to_owned(),
            text: "Deviation is 7.4° E.".to_owned(),
            path: "/alerts#1".to_owned(),
        };
        json!({ "id": 1, "kind": "alert.raised", "words": words }).to_string()
    }

    fn sent(format: Format, queued: &str) -> Value {
        let body = format.body(queued, Some("https://binnacle.example/"));
        serde_json::from_str(&body.unwrap()).unwrap()
    }

    #[test]
    fn a_program_gets_the_message_as_it_was_queued() {
        assert_eq!(Format::Binnacle.body(&queued(), None).unwrap(), queued());
    }

    #[test]
    fn a_chat_gets_headline_text_and_link() {
        assert_eq!(
            sent(Format::Slack, &queued()),
            json!({ "text": "*Nao &lt;1&gt; &amp; co: warning*\nDeviation is 7.4° E.\n\
                             <https://binnacle.example/alerts#1|Open in Binnacle>" })
        );
        let card = &sent(Format::Teams, &queued())["attachments"][0]["content"];
        assert_eq!(card["type"], "AdaptiveCard");
        assert_eq!(card["body"][0]["text"], "Nao <1> & co: warning");
        assert_eq!(card["body"][1]["text"], "Deviation is 7.4° E.");
        assert_eq!(
            card["actions"][0]["url"],
            "https://binnacle.example/alerts#1"
        );
    }

    #[test]
    fn a_chat_gets_what_an_older_release_queued_too() {
        let sent = sent(Format::Slack, r#"{ "kind": "alert.raised" }"#);
        assert!(sent["text"].as_str().unwrap().starts_with("*alert.raised*"));
        assert!(Format::Slack.body("no message", None).is_err());
    }
}
