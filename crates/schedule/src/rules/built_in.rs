//! The rules that come with the product.

use super::Rule;
use std::sync::OnceLock;

static RULES: OnceLock<Vec<Rule>> = OnceLock::new();

/// Returns the rules of `data/rules.json`.
#[allow(clippy::missing_panics_doc, reason = "a test reads the same file")]
pub fn built_in_rules() -> &'static [Rule] {
    RULES.get_or_init(|| {
        serde_json::from_str(include_str!("../../data/rules.json"))
            .expect("the rules that are compiled in are read by a test")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::Requirement;
    use std::collections::BTreeSet;

    #[test]
    fn every_shipped_rule_has_a_name_of_its_own_and_a_source() {
        let names: BTreeSet<&str> = built_in_rules()
            .iter()
            .map(|rule| rule.id.as_str())
            .collect();
        assert_eq!(names.len(), built_in_rules().len());
        assert!(
            built_in_rules()
                .iter()
                .all(|rule| !rule.citation.document.is_empty())
        );
    }

    #[test]
    fn only_a_transits_rule_names_a_canal() {
        for rule in built_in_rules() {
            let transit = matches!(rule.requires, Requirement::Transit { .. });
            assert_eq!(transit, rule.applies.canal.is_some(), "{}", rule.id);
        }
    }

    #[test]
    fn a_rule_of_no_months_or_of_a_misspelt_field_is_no_rule() {
        let rule = |requires: &str| {
            let text = format!(
                r#"{{"id":"x","applies":{{}},"requires":{requires},"citation":{{"document":"d","read":"first_hand"}}}}"#
            );
            serde_json::from_str::<Rule>(&text)
        };
        assert!(rule(r#"{"kind":"interval","months":12}"#).is_ok());
        assert!(rule(r#"{"kind":"interval","months":0}"#).is_err());
        assert!(rule(r#"{"kind":"interval","month":12}"#).is_err());
        assert!(rule(r#"{"kind":"deviation","adjust_above_deg":-5}"#).is_err());
    }
}
