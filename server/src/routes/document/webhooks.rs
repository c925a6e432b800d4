//! Webhooks of the document: the requests that this server sends to its users' programs.

use binnacle_fleet::alerts::{self, AlertMessage};
use binnacle_orders::work_orders::{self, WorkOrderMessage};
use binnacle_platform::webhooks::{DeclaredKind, SIGNATURE_HEADER, TEST, TestMessage};
use std::borrow::Cow;
use utoipa::ToSchema;
use utoipa::openapi::path::{OperationBuilder, Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::request_body::RequestBodyBuilder;
use utoipa::openapi::security::SecurityRequirement;
use utoipa::openapi::{
    Content, HttpMethod, ObjectBuilder, OpenApi, PathItem, Paths, Ref, Required, Response, Type,
};

/// Adds a webhook for each kind of message that webhooks get.
pub(super) fn add(document: &mut OpenApi) {
    let alerts = add_schema::<AlertMessage<'_>>(document);
    let orders = add_schema::<WorkOrderMessage<'_>>(document);
    let tests = add_schema::<TestMessage>(document);
    let mut webhooks = Paths::new();
    let mut add = |kinds: &[DeclaredKind], schema: &str| {
        for kind in kinds {
            let item = PathItem::new(HttpMethod::Post, message(kind, schema));
            webhooks.paths.insert(kind.kind.name().to_owned(), item);
        }
    };
    add(&alerts::message_kinds::ALL, &alerts);
    add(&work_orders::message_kinds::ALL, &orders);
    add(&[TEST], &tests);
    document.webhooks = Some(webhooks);
}

/// Adds a schema with all that it refers to, and returns its name.
fn add_schema<T: ToSchema>(document: &mut OpenApi) -> Cow<'static, str> {
    let mut referenced = Vec::new();
    T::schemas(&mut referenced);
    referenced.push((T::name().into_owned(), T::schema()));
    let schemas = &mut document.components.get_or_insert_default().schemas;
    for (name, schema) in referenced {
        // Those that are there already were completed, as by the names of all kinds.
        schemas.entry(name).or_insert(schema);
    }
    T::name()
}

fn message(kind: &DeclaredKind, schema: &str) -> OperationBuilder {
    let name = kind.kind.name();
    let body = Content::new(Some(Ref::from_schema_name(schema)));
    OperationBuilder::new()
        .tag("webhooks")
        .summary(Some(kind.occasion))
        .description(Some(
            "Sent until it is accepted, for a day. The same message has the same `id`.",
        ))
        .operation_id(Some(format!("receive_{}", name.replace('.', "_"))))
        .securities(Some([SecurityRequirement::default()]))
        .parameter(signature())
        .request_body(Some(
            RequestBodyBuilder::new()
                .content("application/json", body)
                .required(Some(Required::True))
                .build(),
        ))
        .response("2XX", Response::new("The message is accepted"))
        .response("default", Response::new("It is sent again later"))
}

fn signature() -> Parameter {
    ParameterBuilder::new()
        .name(SIGNATURE_HEADER)
        .parameter_in(ParameterIn::Header)
        .required(Required::True)
        .description(Some(
            "`t=SECONDS,v1=HEX`: time of this try, seconds since 1970, and the HMAC-SHA-256 \
             (RFC 2104) with the webhook's secret over these digits, a full stop and the body",
        ))
        .schema(Some(ObjectBuilder::new().schema_type(Type::String)))
        .build()
}
