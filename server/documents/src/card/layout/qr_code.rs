//! QR code (ISO/IEC 18004) on a sheet.

use binnacle_drawing::{Point, Sheet};
use qrcode::{Color, EcLevel, QrCode};

/// Draws the code of a text as a square with its upper left corner at `at`. Returns false where the
/// text is too long for one.
pub(super) fn draw(sheet: &mut Sheet, at: Point, side: f32, text: &str) -> bool {
    let Ok(code) = QrCode::with_error_correction_level(text, EcLevel::L) else {
        return false;
    };
    let width = code.width();
    let module = side / width as f32;
    for (row, colors) in code.to_colors().chunks(width).enumerate() {
        let y = at.1 + module * row as f32;
        let mut x = at.0;
        // Dark modules beside each other are one mark: printers leave no gaps in it.
        for run in colors.chunk_by(|a, b| a == b) {
            let end = x + module * run.len() as f32;
            if run[0] == Color::Dark {
                let bottom = y + module;
                sheet.area(vec![(x, y), (end, y), (end, bottom), (x, bottom)], 0);
            }
            x = end;
        }
    }
    true
}
