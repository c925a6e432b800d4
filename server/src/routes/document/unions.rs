//! Tagged unions: each variant is a schema of its own, and its tag selects it.
//!
//! Generators of clients name what has a name. They know neither inline variants nor those
//! that are put together from others.

use binnacle_compass::openapi::flatten;
use std::collections::BTreeMap;
use utoipa::openapi::schema::{Discriminator, Object, OneOf, Schema};
use utoipa::openapi::{OpenApi, Ref, RefOr};

type Schemas = BTreeMap<String, RefOr<Schema>>;

/// Gives each variant of a tagged union a schema, named after the union and its tag.
///
/// # Panics
/// Panics when a variant's name is that of another schema: a mistake in the code.
pub(super) fn name_variants(document: &mut OpenApi) {
    let schemas = &mut document.components.get_or_insert_default().schemas;
    let before: Schemas = schemas.clone().into_iter().collect();
    for (name, schema) in &before {
        let RefOr::T(Schema::OneOf(union)) = schema else {
            continue;
        };
        let Some((tag, variants)) = tagged_variants(union, &before) else {
            continue;
        };
        let mut discriminator = Discriminator::new(tag);
        let mut named = union.clone();
        named.items.clear();
        for (value, variant) in variants {
            let own_name = format!("{name}{}", camel_case(&value));
            let reference = Ref::from_schema_name(&own_name);
            let location = reference.ref_location.clone();
            discriminator.mapping.insert(value, location);
            named.items.push(RefOr::Ref(reference));
            let known = schemas.insert(own_name.clone(), RefOr::T(Schema::Object(variant)));
            assert!(known.is_none(), "two schemas have the name {own_name}");
        }
        named.discriminator = Some(discriminator);
        schemas.insert(name.clone(), RefOr::T(Schema::OneOf(named)));
    }
}

/// Returns the property that all variants have as their tag, and the variants by its value.
fn tagged_variants(union: &OneOf, schemas: &Schemas) -> Option<(String, Vec<(String, Object)>)> {
    let variants: Option<Vec<Object>> = union
        .items
        .iter()
        .map(|item| whole_object(item, schemas))
        .collect();
    let variants = variants.filter(|variants| variants.len() > 1)?;
    let tag = variants[0].properties.keys().find(|property| {
        let is_tag = |variant: &Object| tag_value(variant, property).is_some();
        variants.iter().all(is_tag)
    })?;
    let tag = tag.clone();
    let by_value = variants.into_iter().map(|variant| {
        let value = tag_value(&variant, &tag).expect("each variant has the tag");
        (value, variant)
    });
    let by_value = by_value.collect();
    Some((tag, by_value))
}

/// Returns the only value that a property may have.
fn tag_value(variant: &Object, property: &str) -> Option<String> {
    let RefOr::T(Schema::Object(tag)) = variant.properties.get(property)? else {
        return None;
    };
    match tag.enum_values.as_deref()? {
        [only] => only.as_str().map(str::to_owned),
        _ => None,
    }
}

/// Returns an object, or a combination of objects, as one object.
fn whole_object(item: &RefOr<Schema>, schemas: &Schemas) -> Option<Object> {
    let RefOr::T(schema) = item else { return None };
    let mut schema = schema.clone();
    if let Schema::AllOf(parts) = &mut schema {
        for part in &mut parts.items {
            if let RefOr::Ref(reference) = part {
                let (_, name) = reference.ref_location.rsplit_once('/')?;
                *part = schemas.get(name)?.clone();
            }
        }
    }
    flatten(&mut schema);
    match schema {
        Schema::Object(object) => Some(object),
        _ => None,
    }
}

fn camel_case(snake_case: &str) -> String {
    let words = snake_case.split('_').map(|word| {
        let mut letters = word.chars();
        let first = letters.next().map(|first| first.to_ascii_uppercase());
        first.into_iter().chain(letters).collect::<String>()
    });
    words.collect()
}
