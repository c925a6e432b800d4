//! A model in its JSON form, for a column of the database.

use binnacle_compass::model::Model;
use serde::{Deserialize, Serialize};

/// A fitted model, as `fit --json` prints it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ModelJson(pub Model);

impl TryFrom<String> for ModelJson {
    type Error = serde_json::Error;

    fn try_from(text: String) -> Result<ModelJson, serde_json::Error> {
        serde_json::from_str(&text)
    }
}
