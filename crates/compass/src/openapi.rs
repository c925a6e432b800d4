//! Schemas for an OpenAPI document.
//!
//! Most types derive theirs. This module holds the rest: types whose written form is
//! another type, and corrections of derived schemas.

use utoipa::openapi::schema::{AdditionalProperties, AllOf, Object};
use utoipa::openapi::{OpenApi, RefOr, Schema};

/// Gives a type the schema of its written form, under a name of its own.
///
/// A derived schema does not register the arguments of a generic form, so they follow it.
macro_rules! named_schema {
    ($type:ty, $name:literal, $form:ty $(, $argument:ty)*) => {
        impl utoipa::PartialSchema for $type {
            fn schema() -> utoipa::openapi::RefOr<utoipa::openapi::Schema> {
                <$form as utoipa::PartialSchema>::schema()
            }
        }

        impl utoipa::ToSchema for $type {
            fn name() -> std::borrow::Cow<'static, str> {
                $name.into()
            }

            fn schemas(
                schemas: &mut Vec<(String, utoipa::openapi::RefOr<utoipa::openapi::Schema>)>,
            ) {
                <$form as utoipa::ToSchema>::schemas(schemas);
                $(
                    schemas.push((
                        <$argument as utoipa::ToSchema>::name().into_owned(),
                        <$argument as utoipa::PartialSchema>::schema(),
                    ));
                    <$argument as utoipa::ToSchema>::schemas(schemas);
                )*
            }
        }
    };
}
pub(crate) use named_schema;

/// Corrects the schemas of this crate's types in a document.
///
/// Flattened fields become fields of the object itself. Defaults of settings are left out,
/// because a response always has every setting. The caution of a later version is left
/// out, because no server sends it.
pub fn correct(document: &mut OpenApi) {
    for name in ["Sample", "HeadingSuggestion"] {
        if let Some(schema) = schema_mut(document, name) {
            flatten(schema);
        }
    }
    if let Some(schema) = schema_mut(document, "ReadingSettings") {
        remove_defaults(schema);
    }
    if let Some(Schema::OneOf(cautions)) = schema_mut(document, "Caution") {
        cautions.items.retain(|item| !is_other_caution(item));
    }
}

/// Finds a schema of the document by name.
pub fn schema_mut<'d>(document: &'d mut OpenApi, name: &str) -> Option<&'d mut Schema> {
    match document.components.as_mut()?.schemas.get_mut(name)? {
        RefOr::T(schema) => Some(schema),
        RefOr::Ref(_) => None,
    }
}

/// Removes the ban on unknown properties from a schema.
pub fn allow_unknown_properties(schema: &mut Schema) {
    if let Schema::Object(object) = schema
        && let Some(AdditionalProperties::FreeForm(false)) = object.additional_properties.as_deref()
    {
        object.additional_properties = None;
    }
}

/// Removes the defaults of an object's properties.
pub fn remove_defaults(schema: &mut Schema) {
    let Schema::Object(object) = schema else {
        return;
    };
    for property in object.properties.values_mut() {
        match property {
            RefOr::T(Schema::Object(value)) => value.default = None,
            RefOr::T(Schema::AllOf(value)) => value.default = None,
            RefOr::T(Schema::OneOf(value)) => value.default = None,
            RefOr::Ref(reference) => reference.default = None,
            RefOr::T(_) => {}
        }
    }
}

/// Replaces a combination of inline objects by one object with all their properties.
pub fn flatten(schema: &mut Schema) {
    if let Schema::AllOf(parts) = schema {
        let mut whole = Object::new();
        whole.description = parts.description.take();
        gather(parts, &mut whole);
        *schema = Schema::Object(whole);
    }
}

fn gather(parts: &AllOf, whole: &mut Object) {
    for part in &parts.items {
        match part {
            RefOr::T(Schema::AllOf(inner)) => gather(inner, whole),
            RefOr::T(Schema::Object(object)) => {
                whole.properties.extend(object.properties.clone());
                whole.required.extend(object.required.clone());
            }
            _ => {}
        }
    }
}

fn is_other_caution(item: &RefOr<Schema>) -> bool {
    let RefOr::T(Schema::Object(object)) = item else {
        return false;
    };
    let Some(RefOr::T(Schema::Object(tag))) = object.properties.get("caution") else {
        return false;
    };
    let names = tag.enum_values.iter().flatten();
    names.into_iter().any(|name| name == "other")
}
