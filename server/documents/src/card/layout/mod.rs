//! Layout of a card on a sheet of A4.
//!
//! Invariants: table and curve share their lines, so that a heading is read straight across. All
//! statements of the card stand on the one sheet.

mod chart;
mod foot;
mod head;
mod qr_code;
mod style;
mod table;

use super::contents::Card;
use binnacle_drawing::{About, Sheet};

/// Draws the card's sheet.
pub(super) fn sheet(card: &Card) -> Sheet {
    let mut sheet = Sheet::a4();
    let below_head = head::draw(&mut sheet, card);
    let lines = table::Lines {
        top: below_head + 38.0,
    };
    table::draw(&mut sheet, card, &lines);
    chart::draw(&mut sheet, card, &lines);
    foot::draw(&mut sheet, card, lines.bottom() + 16.0);
    sheet
}

/// Returns the metadata of the document.
pub(super) fn about(card: &Card) -> About {
    About {
        title: format!(
            "Deviation card ({}): {}, {}",
            card.status.word(),
            card.vessel.name,
            card.compass.name
        ),
        created: card.model.fitted_at.0,
    }
}
