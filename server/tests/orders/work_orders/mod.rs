//! Work orders from the berth reading to the verification at sea.

mod again;
mod card;
mod codes;
mod evidence;
mod held;
mod limits;
mod refusals;
mod strength;
mod way;
