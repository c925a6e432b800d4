//! Checks of single values; each error names its field.

use super::error::BinnacleError;

/// Version of the written forms of binnacles and designs.
pub const VERSION: u32 = 1;

pub(super) type Checked = Result<(), BinnacleError>;

/// Greatest length of a list; a longer one is a mistake in the file.
const MOST: usize = 64;

pub(super) fn version(found: u32) -> Checked {
    if found == VERSION {
        return Ok(());
    }
    let what = format!("a form of version {found}; this program reads version {VERSION}");
    Err(BinnacleError::new("version", what))
}

pub(super) fn text_given(field: &str, text: &str) -> Checked {
    if text.trim().is_empty() {
        return Err(BinnacleError::new(field, "is empty"));
    }
    Ok(())
}

pub(super) fn number(field: &str, value: f64, least: f64, greatest: f64) -> Checked {
    if (least..=greatest).contains(&value) {
        return Ok(());
    }
    let what = format!("{value} is not a number between {least} and {greatest}");
    Err(BinnacleError::new(field, what))
}

pub(super) fn count(field: &str, length: usize) -> Checked {
    match length {
        0 => Err(BinnacleError::new(field, "is empty: name at least one")),
        _ if length > MOST => {
            let what = format!("{length} of them; at most {MOST} are accepted");
            Err(BinnacleError::new(field, what))
        }
        _ => Ok(()),
    }
}
