//! The designs that come with the product. They are ideal shapes after the formulas
//! of docs/science.md, not any maker's data, and say so in their provenance.

/// Name and written form of each.
pub const SHIPPED: [(&str, &str); 2] = [
    (
        "class_a_trays",
        include_str!("../../binnacles/class_a_trays.json"),
    ),
    (
        "small_holes",
        include_str!("../../binnacles/small_holes.json"),
    ),
];
