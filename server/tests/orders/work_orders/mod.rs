//! Work orders: from the berth's reading to the evidence and the proof at sea.

mod again;
mod card;
mod codes;
mod evidence;
mod held;
mod limits;
mod refusals;
mod strength;
mod way;
