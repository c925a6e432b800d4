//! Designs shipped with the product: ideal shapes by the formulas of docs/science.md, not
//! any maker's data. Their provenance says so.

/// Name and written form of each design.
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
