//! Reads an input from its text.

use super::error::InputError;
use super::{Checked, Input, check};

/// Reads and checks an input.
///
/// # Errors
/// The first fault.
pub fn read(text: &str) -> Result<Checked, InputError> {
    let mut json = serde_json::Deserializer::from_str(text);
    let input: Input = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let path = match error.path().to_string() {
            whole if whole == "." => "$".to_owned(),
            path => path,
        };
        InputError::new(path, error.inner().to_string())
    })?;
    json.end()
        .map_err(|error| InputError::new("$", error.to_string()))?;
    check::check(input)
}
