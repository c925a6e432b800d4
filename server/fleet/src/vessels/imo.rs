//! IMO ship identification numbers.

/// Tells whether seven digits end in the check digit of the first six: the last digit of 7a + 6b +
/// 5c + 4d + 3e + 2f (IMO Resolution A.1117(30)).
pub(super) fn is_valid(number: &str) -> bool {
    let digits: Vec<u32> = number
        .chars()
        .filter_map(|letter| letter.to_digit(10))
        .collect();
    if digits.len() != 7 || number.len() != 7 {
        return false;
    }
    let sum: u32 = digits.iter().zip((2..=7).rev()).map(|(d, w)| d * w).sum();
    sum % 10 == digits[6]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_digit_checks_the_others() {
        assert!(is_valid("9074729"));
        for wrong in ["9074728", "907472", "90747290", "907472X", ""] {
            assert!(!is_valid(wrong), "{wrong:?}");
        }
    }
}
