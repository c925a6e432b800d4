//! The examples of docs/schedule.md are real results.

use binnacle_schedule::input::read;
use binnacle_schedule::plan::plan;
use serde_json::{Value, from_str, to_value};

fn blocks() -> Vec<&'static str> {
    let text = include_str!("../../../../docs/schedule.md");
    let blocks = text.split("```json\n").skip(1);
    blocks
        .map(|block| block.split_once("```").unwrap().0)
        .collect()
}

/// True if one value contains everything of another.
fn has(whole: &Value, part: &Value) -> bool {
    match (whole, part) {
        (Value::Object(whole), Value::Object(part)) => part
            .iter()
            .all(|(name, part)| whole.get(name).is_some_and(|whole| has(whole, part))),
        (Value::Array(whole), Value::Array(part)) => {
            whole.len() == part.len()
                && whole.iter().zip(part).all(|(whole, part)| has(whole, part))
        }
        _ => whole == part,
    }
}

#[test]
fn the_documented_schedule_is_the_real_one() {
    let blocks = blocks();
    let answer = to_value(plan(&read(blocks[0]).unwrap())).unwrap();
    let documented: Value = from_str(blocks[1]).unwrap();
    assert!(has(&answer, &documented), "{answer:#}");
}
