//! Text tables.

/// Renders right-aligned columns under their names.
pub(super) fn render<const N: usize>(names: [&str; N], rows: &[[String; N]]) -> String {
    let widths: [usize; N] = std::array::from_fn(|column| {
        rows.iter()
            .map(|row| row[column].chars().count())
            .chain([names[column].len()])
            .max()
            .unwrap_or(0)
    });
    let line = |cells: [&str; N]| {
        let padded: Vec<String> = cells
            .iter()
            .zip(widths)
            .map(|(cell, width)| format!("{cell:>width$}"))
            .collect();
        padded.join("  ")
    };
    let mut text = line(names);
    for row in rows {
        text.push('\n');
        text.push_str(&line(std::array::from_fn(|column| row[column].as_str())));
    }
    text
}
