//! Input of a plan: berth, binnacle, waters and limits.

mod adjustment;
mod limits;
mod vertical_reading;

mod reading_form;
mod second_reading_form;
mod unit;

mod berth_form;

mod error;
mod number_error;
mod validation;

pub use adjustment::{Adjustment, Circumstances, EarlierLambda, Water};
pub use berth_form::{Berth, BerthForm, FieldForm, FormError, PostCheckForm, WaterForm};
pub use error::AdjustError;
pub use limits::Limits;
pub use number_error::NumberError;
pub use reading_form::{HeadingFrom, Magnetometer, ReadingForm, ShiftedReading};
pub use second_reading_form::SecondReadingForm;
pub use unit::Unit;
pub(crate) use validation::validate;
pub use vertical_reading::VerticalReading;
