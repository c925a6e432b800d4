//! OpenAPI document, and a readable page of it.
//!
//! The page is generated from the document, without scripts and external resources, so that it
//! works on a closed network too.

use axum::Json;
use axum::response::Html;
use serde_json::Value;
use std::fmt::Write;
use std::sync::LazyLock;

pub(super) static DOCUMENT: LazyLock<Value> = LazyLock::new(|| {
    serde_json::to_value(super::openapi()).expect("the document is made of strings and maps")
});
static PAGE: LazyLock<String> = LazyLock::new(|| render(&DOCUMENT));

pub(super) async fn document() -> Json<&'static Value> {
    Json(&DOCUMENT)
}

pub(super) async fn page() -> Html<&'static str> {
    Html(&PAGE)
}

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;\
    padding:0 1rem}code{background:#8882;padding:.1em .3em;border-radius:.2em}\
    section{border-top:1px solid #8884;margin-top:1.5rem}h3{margin-bottom:.2rem}\
    td,th{text-align:left;padding:.15rem 1rem .15rem 0;vertical-align:top}\
    :root{color-scheme:light dark}";

fn render(document: &Value) -> String {
    let mut page = format!(
        "<!doctype html><html lang=en><meta charset=utf-8>\
         <meta name=viewport content='width=device-width'>\
         <title>Binnacle API</title><style>{STYLE}</style><h1>Binnacle API</h1><p>{}</p>\
         <p>For programs: <a href=/api/openapi.json>openapi.json</a> (OpenAPI 3.1).</p>",
        text(&document["info"]["description"])
    );
    for (path, operations) in entries(&document["paths"]) {
        for (method, operation) in entries(operations) {
            operation_section(&mut page, path, method, operation);
        }
    }
    page.push_str("<h2>Schemas</h2>");
    for (name, schema) in entries(&document["components"]["schemas"]) {
        schema_section(&mut page, name, schema);
    }
    page.push_str("</html>");
    page
}

fn operation_section(page: &mut String, path: &str, method: &str, operation: &Value) {
    let _ = write!(
        page,
        "<section><h3><code>{} {}</code></h3><p><strong>{}</strong> {}</p>",
        method.to_uppercase(),
        escape(path),
        text(&operation["summary"]),
        text(&operation["description"])
    );
    let body = &operation["requestBody"]["content"];
    for (media, content) in entries(body) {
        let _ = write!(
            page,
            "<p>Body: {} {}</p>",
            escape(media),
            kind(&content["schema"])
        );
    }
    page.push_str("<table>");
    for parameter in operation["parameters"].as_array().into_iter().flatten() {
        let _ = write!(
            page,
            "<tr><td><code>{}</code><td>{}<td>{}<td>{}",
            text(&parameter["name"]),
            text(&parameter["in"]),
            kind(&parameter["schema"]),
            text(&parameter["description"])
        );
    }
    for (status, response) in entries(&operation["responses"]) {
        let schema = entries(&response["content"])
            .next()
            .map(|(_, content)| kind(&content["schema"]));
        let _ = write!(
            page,
            "<tr><td>{}<td>response<td>{}<td>{}",
            escape(status),
            schema.unwrap_or_default(),
            text(&response["description"])
        );
    }
    page.push_str("</table></section>");
}

fn schema_section(page: &mut String, name: &str, schema: &Value) {
    let _ = write!(
        page,
        "<section id='{0}'><h3>{0}</h3><p>{1}</p><table>",
        escape(name),
        text(&schema["description"])
    );
    let parts = schema["allOf"].as_array().cloned().unwrap_or_default();
    for part in std::iter::once(schema).chain(&parts) {
        if part["$ref"].is_string() {
            let _ = write!(page, "<tr><td>all of<td>{}<td>", kind(part));
        }
        for (field, about) in entries(&part["properties"]) {
            let _ = write!(
                page,
                "<tr><td><code>{}</code><td>{}<td>{}",
                escape(field),
                kind(about),
                text(&about["description"])
            );
        }
    }
    page.push_str("</table></section>");
}

/// Returns a short description of a schema, with links.
fn kind(schema: &Value) -> String {
    if let Some(name) = schema["$ref"]
        .as_str()
        .and_then(|path| path.rsplit('/').next())
    {
        return format!("<a href='#{0}'>{0}</a>", escape(name));
    }
    if let Some(choices) = schema["oneOf"].as_array().or(schema["anyOf"].as_array()) {
        let choices: Vec<String> = choices.iter().map(kind).collect();
        return choices.join(" or ");
    }
    if schema["type"] == "array" {
        return format!("list of {}", kind(&schema["items"]));
    }
    let names: Vec<&str> = match &schema["type"] {
        Value::Array(names) => names.iter().filter_map(Value::as_str).collect(),
        name => name.as_str().into_iter().collect(),
    };
    format!(
        "{} {}",
        escape(&names.join(" or ")),
        text(&schema["format"])
    )
}

fn entries(value: &Value) -> impl Iterator<Item = (&String, &Value)> {
    value.as_object().into_iter().flatten()
}

fn text(value: &Value) -> String {
    escape(value.as_str().unwrap_or_default())
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('\'', "&#39;")
        .replace('"', "&quot;")
}
