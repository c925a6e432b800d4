//! Work orders from the berth reading to the verification at sea.

mod as_found;
mod card;
mod evidence;
mod invalid_requests;
mod limits;
mod magnet_strength;
mod preconditions;
mod refusal_codes;
mod second_reading;
mod whole_order;
